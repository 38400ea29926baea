#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what the operations take of memory, compares it with what is published beside each and writes docs/memory.md;
./dev memory calls it. With --points it judges one size only, and writes nothing; a test does."""
import argparse
import json
import os
import sys
import tempfile

sys.dont_write_bytecode = True  # the sources may not be ours to write to
from measuring import Runner, conditions

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
POINTS = (10_000, 50_000, 250_000)
SLACK = (16 + 8 * os.cpu_count()) * 2**20  # tables of CRSs and buffers; the stacks of threads

# The easiest of everything, and the hungriest of what is usual. a, b, c: surveys of one place that have no vertex in
# common; tiles: nine, neighbours overlapping by 5 %; level_a, level_b: binary surfaces; small: a mesh of 2,000 faces.
LOGIC = ['{level_a} {level_a}', '{level_a} {level_b}']
FACES = {
    'add': ['{a} 5', '{a} {a}', '{a} {b}'],
    'subtract': ['{a} 5', '{a} {a}', '{a} {b}'],
    'merge': ['{a}', '{tiles}', '{a} {b}', '{a} {b} --overlap=median', '{a} {b} --overlap=blend --blend-width=500'],
    'seams': ['{a}', '{tiles}', '{a} {b}', '{a} {b} --overlap=median'],
    'volume': ['{a} 0', '{a} {a}', '{a} {b}', '{a} {b} --polygons=true --format=geojson'],
    'and': LOGIC, 'or': LOGIC, 'xor': LOGIC, 'nand': LOGIC, 'nor': LOGIC,
    'not': ['{level_a}'],
    'threshold': ['{a} --level=1e6', '{a} --level=0'],
    'quantize': ['{a} --levels=1e6', '{a} --levels=-300:300:50'],
    'clip': ['{a} --bbox=1,1,100,100', '{a} --bbox=1,1,9999,9999'],
    'synthesize-rectangle': ['--xmin=0 --ymin=0 --xmax=10000 --ymax=10000 --max-edge={edge}'],
    'synthesize-circle': ['--center=0,0 --radius=5000 --max-edge={edge}', '--center=0,0 --radius=5000 --samples={points}'],
    'synthesize-ellipse': ['--center=0,0 --major-axis=10000 --minor-axis=8000 --max-edge={edge}'],
    'synthesize-polygon': ['--points=0,0;10000,0;9000,9000;0,10000 --max-edge={edge}'],
    'triangulate': ['{dem}', '{table}', '{table} --max-error=1'],
    'rasterize': ['{a}'],
    'render': ['{a}'],
    'profile': ['{a} --line=100,100;9000,9000'],
    'sample': ['{a} --points=100,100;9000,9000'],
    'contour': ['{a} --interval=1e6', '{a} --interval=20'],
    'simplify': ['{a} --coplanar-only=true', '{a} --max-error=1', '{a} --max-error=50'],
    'transform': ['{a} --assume-crs=EPSG:25832 --target-crs=EPSG:25833'],
    'validate': ['{a}', '{a} --repair=true --format=ply'],
    'info': ['{a}'],
    'convert': ['{a} --format=ply', '{a} --format=obj', '{a} --format=json', '{a} --provenance=true'],
}
CELLS = {
    'rasterize': ['{small} --width={side} --height={side}', '{small} --width={side} --height={side} --format=asc'],
    'render': ['{small} --size={side} --shading=hillshade', '{small} --size={side}'],
}
UNPUBLISHED = [('merge', '{a} {b} {c} --overlap=mean', 'face'), ('convert', '{a} --grid=0.001', 'face'),
               ('triangulate', '{dem} --max-error=1e5', 'sample')]

TEXT = '''<!-- Written by `./dev memory`. -->
# Memory

What one execution may take is the setting `job-memory` of the service, and on the command line what `ulimit -v` says. It
needs the sum of

- the program: {program} MB of address space, of which 35 MB are its own, up to 16 MB for tables and buffers, and 8 MB for
  the stack of every thread;
- the bytes of the request;
- for each face of its inputs the bytes that are published beside each operation: here, in the
  [reference](reference.md), and as `additionalParameters` at `/processes/ID`. A raster counts with the faces of the TIN
  that it becomes, a point as two faces. For each cell of a raster or picture that it makes there are bytes, too.

Two figures are published. Nothing takes less than the **least**: an execution that has no room for it fails at once, with
413 and `out-of-memory`, and is told what it needs. Terrain like that below takes no more than the **most**, with which one
plans. Between the two it depends on how much the surfaces have in common. What runs out of memory on its way is told how
much it had taken, and what was to be expected.

Each case below ran in three sizes, on {threads} threads; first stands how much there was in the largest, then the bytes for
each in the three, the share of the program's tables and stacks included, which is most of it in the smallest.

Not in the published figures: of n surveys on top of each other `merge` keeps every crossing where it averages them, which
grows with n²; `grid` rounds the faces of the result; a raster itself. They have a table of their own below.
'''


class Inputs:
    """Files of one size, made when a case first names them."""

    def __init__(self, runner, points):
        self.runner, self.points = runner, points
        self.edge, self.side = 15000 / points ** 0.5, 8 * round(points ** 0.5)

    def __getitem__(self, name):
        return getattr(self, name)

    def mesh(self, seed, points=None, x=0, y=0):
        points = points or self.points
        return self.runner.mesh(f'm{seed}-{points}', '--points', points, '--seed', seed, '--x', x, '--y', y)

    a, b, c = (property(lambda self, seed=seed: self.mesh(seed)) for seed in (1, 2, 3))
    small = property(lambda self: self.mesh(1, 1000))
    tiles = property(lambda self: ' '.join(self.mesh(10 + k, self.points // 9, 9500 * (k % 3), 9500 * (k // 3))
                                           for k in range(9)))
    samples = property(lambda self: 2 ** round(self.points.bit_length() / 2) + 1)
    dem = property(lambda self: self.raster(3))
    level_a = property(lambda self: self.level(1))
    level_b = property(lambda self: self.level(2))

    def raster(self, seed):
        path = self.runner.file(f'dem{seed}-{self.samples}.tif')
        if not os.path.exists(path):
            self.runner.bench('dem', path, '--size', self.samples, '--seed', seed)
        return path

    def level(self, seed):
        path = self.runner.file(f'level{seed}-{self.points}.ply')
        if not os.path.exists(path):
            self.runner.terrane('threshold', self.mesh(seed), '--level', 0, '-o', path)
        return path

    @property
    def table(self):
        path = self.runner.file(f'points-{self.points}.csv')
        with open(path, 'w', encoding='ascii') as file:
            for i in range(self.points):  # spread evenly, heights without order
                x, y = 1e4 * (i * 0.7548776662466927 % 1), 1e4 * (i * 0.5698402909980532 % 1)
                file.write(f'{x:.3f},{y:.3f},{i * 7919 % 1009 / 100:.2f}\n')
        return path


class Case:
    """What one execution takes, in several sizes, for each of what its unit counts."""

    def __init__(self, operation, words, unit):
        self.operation, self.words, self.unit = operation, words, unit
        self.sizes, self.published = [], None

    def run(self, inputs):
        said = inputs.runner.bench('memory', self.operation, *self.words.format_map(inputs).split())
        count = {'face': said['faces'], 'cell': inputs.side ** 2, 'sample': inputs.samples ** 2}[self.unit]
        self.published = said.get(f'bytes_per_{self.unit}')
        self.sizes.append((said['bytes'], count))
        inputs.runner.progress(f'{self}: {self.figures()[-1]} bytes for each of {count} {self.unit}s')

    def __str__(self):
        return f'{self.operation} {self.words}'.replace('{', '').replace('}', '')

    def figures(self):
        return [round(size / count) for size, count in self.sizes]

    def faults(self):
        least, most = self.published
        for size, count in self.sizes:
            if not least * count <= size <= most * count + SLACK:
                yield f'{self}: {size} bytes for {count} {self.unit}s; published are {least} to {most} for each'

    def row(self, published):
        cells = [f'`{self}`', f'{self.sizes[-1][1]:,}', *map(str, self.figures())]
        if published:
            cells.append('{} to {}'.format(*self.published))
        return f'| {" | ".join(cells)} |'


def table(cases, what, published=True):
    head = ['', what, *(['bytes for each'] * len(POINTS)), *(['published'] * published)]
    return ['| ' + ' | '.join(head) + ' |', '|---' * len(head) + '|', *(case.row(published) for case in cases), '']


def document(program, faces, cells, others):
    text = TEXT.replace('{program}', str(program)).replace('{threads}', str(os.cpu_count()))
    lines = [text, *(f'- {line}' for line in conditions(ROOT)[:2]), '']
    lines += ['## Faces', '', 'Of the inputs; of the result where nothing is read.', '', *table(faces, 'faces')]
    lines += ['## Cells', '', *table(cells, 'cells')]
    lines += ['## Not in the published figures', '', *table(others, 'faces or samples', False)]
    return '\n'.join(lines).rstrip() + '\n'


def every_operation(runner):
    """Those that have geometry, as the service describes them."""
    said, _, _ = runner.run(os.path.join(runner.build, 'terrane'), 'docs', 'openapi-3.0')
    paths = [path.split('/') for path in json.loads(said)['paths'] if path.endswith('/execution')]
    return {words[2] for words in paths} - {'echo'}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--points', type=int, help='of one mesh; nothing is written')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build/release'), help='where the programs are')
    options = parser.parse_args()
    faces, cells = ([Case(operation, words, unit) for operation, cases in list_of.items() for words in cases]
                    for unit, list_of in (('face', FACES), ('cell', CELLS)))
    others = [] if options.points else [Case(*case) for case in UNPUBLISHED]
    with tempfile.TemporaryDirectory(prefix='memory-', dir=options.build) as scratch:
        runner = Runner(options.build, scratch)
        faults = [f'{operation} is not measured' for operation in every_operation(runner) - set(FACES)]
        for points in [options.points] if options.points else POINTS:
            inputs = Inputs(runner, points)
            for case in faces + cells + others:
                case.run(inputs)
        program = runner.bench('memory', 'info', inputs.small)['before'] >> 20
    faults += [fault for case in faces + cells for fault in case.faults()]
    for fault in faults:
        print(fault, file=sys.stderr)
    if not options.points:
        text = document(program, faces, cells, others)  # says whether the tree is as committed: before it is written to
        with open(os.path.join(ROOT, 'docs/memory.md'), 'w', encoding='utf-8') as file:
            file.write(text)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
