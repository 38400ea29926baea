# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests share: one service for a module or a class, which must stop cleanly, and what a refusal looks like."""
import unittest

from service import Service


def close(service):
    code = service.close()
    assert code == 0, f"exit code {code} after SIGTERM"


def for_module(names):
    """setUpModule and tearDownModule of a module whose tests use names["service"]."""
    def set_up():
        names["service"] = Service()

    def tear_down():
        close(names["service"])
    return set_up, tear_down


class Problems(unittest.TestCase):
    def assert_problem(self, answer, status, *words):
        self.assertEqual(answer.status, status, answer.body)
        self.assertEqual(answer.media_type, "application/problem+json", answer.body)
        problem = answer.json()
        self.assertEqual(problem["status"], status)
        for member in "type", "title", "detail":
            self.assertTrue(problem[member], problem)
        for word in words:
            self.assertIn(word, problem["detail"])
        for inside in "json.exception", "GDAL", "CGAL", "std::", "terrane::":
            self.assertNotIn(inside, problem["detail"])
        self.assertIn("X-Request-Id", answer.headers)


class OneService(Problems):
    """A service with `arguments` for all tests of the class."""
    arguments = ()

    @classmethod
    def setUpClass(cls):
        cls.service = Service(*cls.arguments)
        cls.addClassCleanup(close, cls.service)
