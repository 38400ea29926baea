# SPDX-License-Identifier: GPL-3.0-or-later
"""A client that is not ours: OWSLib (Debian package python3-owslib) finds its way from the landing page. It belongs to
Debian's own Python, so the tests run themselves there."""
import os
import subprocess
import unittest

from one_service import OneService

DEBIANS_PYTHON = "/usr/bin/python3"

try:
    from owslib.ogcapi.processes import Processes
except ImportError:
    Processes = None


@unittest.skipIf(Processes, "this is the Python that has OWSLib")
class InDebiansPython(unittest.TestCase):
    def test_all_of_it(self):
        probe = [DEBIANS_PYTHON, "-c", "import owslib.ogcapi.processes"]
        if not os.path.exists(DEBIANS_PYTHON) or subprocess.run(probe, capture_output=True, check=False).returncode:
            self.skipTest("OWSLib is not installed (Debian package python3-owslib)")
        run = subprocess.run([DEBIANS_PYTHON, "-B", __file__], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)


@unittest.skipUnless(Processes, "OWSLib is not in this Python")
class Owslib(OneService):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.client = Processes(f"http://{cls.service.host}:{cls.service.port}")

    def listed(self):
        listing = self.client.processes()
        return listing["processes"] if isinstance(listing, dict) else listing  # later versions give the list

    def test_landing_page_and_conformance(self):
        self.assertEqual(self.client.response["title"], "Terrane")
        self.assertIn("http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core",
                      self.client.conformance()["conformsTo"])

    def test_the_interface_is_found_by_its_link(self):
        api = self.client.api()
        self.assertTrue(api["openapi"].startswith("3.0"))
        self.assertIn("/processes/merge/execution", api["paths"])

    def test_every_process_is_described(self):
        processes = self.listed()
        self.assertGreater(len(processes), 20)
        for summary in processes:
            description = self.client.process(summary["id"])
            self.assertEqual((description["id"], description["version"]), (summary["id"], summary["version"]))
            self.assertTrue(description["outputs"], summary["id"])
            for name, slot in {**description["inputs"], **description["outputs"]}.items():
                self.assertIn("schema", slot, (summary["id"], name))

    def test_a_process_that_is_not_there(self):
        with self.assertRaisesRegex(RuntimeError, "no-such-process"):
            self.client.process("nothing")

    def test_a_base_with_a_query(self):
        client = Processes(f"http://{self.service.host}:{self.service.port}/?f=json")
        self.assertEqual(client.process("echo")["id"], "echo")

    @unittest.skipUnless(hasattr(Processes, "execute"), "this version of OWSLib executes nothing")
    def test_a_process_is_executed(self):
        self.assertIn("hello", str(self.client.execute("echo", {"answer": "hello"}, {"answer": {}})))

    def test_what_it_read_is_enough_to_execute(self):
        """By hand, where OWSLib cannot: the link of the description, with the session's own headers."""
        import requests
        link = next(link for link in self.client.process("echo")["links"] if link["rel"].endswith("/execute"))
        answer = requests.post(link["href"], json={"inputs": {"answer": "hello"}, "response": "document"},
                               headers=self.client.headers, timeout=60)
        self.assertEqual(answer.status_code, 200, answer.text)
        self.assertIn("hello", answer.text)


if __name__ == "__main__":
    unittest.main()
