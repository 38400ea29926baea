# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs we are compared with, built from an outside folder; each may be missing."""
import os
import re
import subprocess

from measuring import NotRun

SOURCES = {'edge_walk': [], 'cgal_cdt': ['-lgmp', '-lmpfr']}


class Baselines:
    def __init__(self, runner, folder):
        self.runner, self.folder = runner, folder
        self.programs, self.missing = {}, {}
        for name, libraries in SOURCES.items():
            try:
                self.programs[name] = self._built(name, libraries)
            except NotRun as reason:
                self.missing[name] = str(reason)

    def _built(self, name, libraries):
        source = os.path.join(self.folder, name + '.cpp')
        if not os.path.exists(source):
            raise NotRun(f'{name}.cpp is not in the folder of baselines (TERRANE_BASELINES, ../shared/reference)')
        out = os.path.join(self.runner.build, 'bench')
        os.makedirs(out, exist_ok=True)
        program = os.path.join(out, name)
        newest = max(os.path.getmtime(os.path.join(self.folder, f)) for f in os.listdir(self.folder))
        if not os.path.exists(program) or os.path.getmtime(program) < newest:
            self.runner.progress(f'building {name}')
            words = ['g++', '-O3', '-march=native', '-std=c++20', source, *libraries, '-o', program]
            if subprocess.run(words, capture_output=True, check=False).returncode != 0:
                raise NotRun(f'{name}.cpp does not compile here')
        return program

    def _run(self, name, *words):
        if name in self.missing:
            raise NotRun(self.missing[name])
        return self.runner.run(self.programs[name], *words)[0]

    def edge_walk(self, a, b):
        """Seconds of preparation and cold overlay: R."""
        out = self._run('edge_walk', a, b, 1)
        found = re.search(r'it0,.* wall=([\d.]+) .* prep=([\d.]+)', out)
        if not found:
            raise NotRun('edge_walk says no time')
        return float(found[1]) + float(found[2])

    def cgal_cdt(self, a, b):
        """Seconds of the constrained Delaunay triangulation of both meshes' edges."""
        found = re.search(r' wall=([\d.]+)', self._run('cgal_cdt', a, b))
        if not found:
            raise NotRun('cgal_cdt says no time')
        return float(found[1])
