#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the whole benchmark and writes its document; ./dev bench calls it. Python's standard library is enough."""
import argparse
import os
import sys
import tempfile

sys.dont_write_bytecode = True  # the sources may not be ours to write to
import document
import file_sections
import overlay_sections
from baselines import Baselines
from measuring import NotRun, Runner, conditions
from subject import Sizes, Subject

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SECTIONS = {'overlay': overlay_sections.overlay, 'growth': overlay_sections.growth, 'merge': overlay_sections.merge,
            'rasters': file_sections.rasters, 'files': file_sections.files}


def sizes(options):
    if options.points:  # everything in proportion: proves that it runs, measures nothing
        return Sizes(options.points, (options.points, 2 * options.points), options.points, 65, 129, options.points, 1,
                     f'Tiny: {options.points} points a mesh. No bound was judged.')
    if options.quick:
        return Sizes(growth=(25_000, 250_000), tile_points=2_000, dem=1025, raster=1025, file_points=250_000, rounds=2,
                     scaled='Quick: smaller sizes, two rounds. No bound was judged.')
    return Sizes()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--quick', action='store_true', help='smaller sizes: minutes, and nothing is judged')
    parser.add_argument('--points', type=int, help='tiny sizes from this many points: proves that it runs')
    parser.add_argument('--rounds', type=int, help='runs of each measurement')
    parser.add_argument('--only', action='append', choices=SECTIONS, help='this section only')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build/release'), help='where the programs are')
    parser.add_argument('--output', default=os.path.join(ROOT, 'docs'), help='folder of the document and its plots')
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    facts = conditions(ROOT)
    with tempfile.TemporaryDirectory(prefix='bench-', dir=options.build) as scratch:
        runner = Runner(options.build, scratch)
        folder = os.environ.get('TERRANE_BASELINES') or os.path.join(ROOT, '../shared/reference')
        wanted = sizes(options)
        wanted.rounds = max(1, options.rounds or wanted.rounds)
        subject = Subject(runner, Baselines(runner, os.path.abspath(folder)), wanted, options.output)
        written = []
        for name in SECTIONS:
            if options.only and name not in options.only:
                written.append(document.Section(name.capitalize(), ''))
                written[-1].cannot('the section', 'not asked for')
                continue
            runner.progress(f'{name}:')
            try:
                written.append(SECTIONS[name](subject))
            except NotRun as reason:
                written.append(document.Section(name.capitalize(), ''))
                written[-1].cannot('the section', str(reason))
                runner.progress(f'{name}: not run: {reason}')
        document.write(options.output, facts, written, runner.elapsed(), wanted.scaled)
        runner.progress(f'wrote {os.path.join(options.output, "benchmarks.md")}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
