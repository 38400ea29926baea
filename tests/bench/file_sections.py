# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters and files."""
import os
import shutil
import subprocess
import sys

from document import Section
from measuring import NotRun


def _dem(subject, seed):
    """A raster, and whether it is the baselines' own; one of our making where theirs cannot be made."""
    path = subject.runner.file(f'dem{seed}.tif')
    maker = os.path.join(subject.baselines.folder, 'make_dem.py')
    subject.runner.progress(f'making dem{seed}')
    if subject.sizes.dem == 4097 and os.path.exists(maker):
        # numpy and GDAL belong to Debian's python3, which need not be the one that runs us.
        for python in (sys.executable, '/usr/bin/python3'):
            if os.path.exists(python) and subprocess.run([python, maker, path, str(seed)], capture_output=True,
                                                         check=False).returncode == 0:
                return path, True
    subject.runner.bench('dem', path, '--size', subject.sizes.dem, '--seed', seed)
    return path, False


def rasters(subject):
    size, rounds = subject.sizes.dem, subject.sizes.rounds
    (a, a_theirs), (b, b_theirs) = _dem(subject, 3), _dem(subject, 4)
    theirs = a_theirs and b_theirs
    section = Section('Rasters', f'A fractal DEM of {size}² samples '
                      f'(of {"make_dem.py" if theirs else "`terrane-bench dem`"}) to a TIN nowhere further than 1 m, '
                      'every sample checked twice, the second time by rasterizing; a TIN to heights on a lattice; and '
                      'the difference of two such DEMs, as rasters and as TINs in binary PLY, whole processes side by '
                      'side.')
    section.table = [['', 'seconds (median)', '']]
    judged = not subject.sizes.scaled and theirs
    said = {}
    contestants = {}
    mesh = subject.pair(subject.sizes.points)[0]
    for threads in sorted({1, min(2, subject.cores)}):
        def tin(threads=threads):
            said['tin'] = subject.runner.bench('triangulate', a, '--threads', threads, '--repeat', 1)
            return said['tin']['seconds']

        def raster(threads=threads):
            said['raster'] = subject.runner.bench('rasterize', mesh, '--size', subject.sizes.raster, '--threads',
                                                  threads, '--repeat', 1)
            return said['raster']['seconds']
        words = f'{threads} thread{"s" * (threads > 1)}'
        contestants |= {f'DEM to TIN, {words}': tin, f'TIN to raster, {words}': raster}
    times, absent = subject.take_turns(contestants, rounds)
    for name, measured in times.items():
        note = (f'{size * size / measured.least / 1e6:.1f} million samples/s, {said["tin"]["points"]:,} points'
                if name.startswith('DEM') else f'{said["raster"]["faces"]:,} faces, {subject.sizes.raster}² cells')
        section.table.append([name, str(measured), note])
    for name, reason in absent.items():
        section.cannot(name, reason)
    two = 'DEM to TIN, 2 threads'
    if two in times:
        section.judge('DEM to TIN, seconds on two threads', times[two].least, most=3.55 / 2, judged=judged,
                      limit='at most 1.775, half of what a greedy tool took on one thread (not run here)')
    elif two not in absent:
        section.cannot('DEM to TIN, seconds on two threads', 'it needs two processors')
    if 'tin' in said:
        points = said['tin']['points']
        section.judge('DEM to TIN, points', points, most=1.02 * 180_000, figure=f'{points:,}', judged=judged,
                      limit='at most 2 % more than about 180,000')
    if 'TIN to raster, 1 thread' in times:
        rate = subject.sizes.raster**2 / times['TIN to raster, 1 thread'].least
        section.judge('TIN to raster, million cells per second and core', rate / 1e6, least=100,
                      figure=f'{rate / 1e6:.0f}', judged=not subject.sizes.scaled)
    try:
        _difference(subject, section, a, b, judged)
    except NotRun as reason:
        section.cannot('TINs / rasters', str(reason))
    return section


def _difference(subject, section, a, b, judged):
    runner = subject.runner
    tins = [runner.file(f'dem{seed}.ply') for seed in (3, 4)]
    for raster, tin in zip((a, b), tins):
        runner.progress(f'triangulating {os.path.basename(raster)}')
        runner.terrane('triangulate', raster, '--max-error', 1, '-o', tin)
    calc = shutil.which('gdal_calc.py')

    def with_rasters():
        if not calc:
            raise NotRun('gdal_calc.py is not installed')
        return runner.run(calc, '-A', a, '-B', b, '--calc=A-B', '--quiet',
                          f'--outfile={runner.absent("difference.tif")}')[1]

    def with_tins():
        return runner.terrane('subtract', *tins, '-o', runner.absent('difference.ply'))[0]
    ours, theirs = 'difference of TINs (terrane subtract)', 'difference of rasters (gdal_calc.py)'
    times, absent = subject.take_turns({ours: with_tins, theirs: with_rasters}, subject.sizes.rounds)
    for name, measured in times.items():
        section.table.append([name, str(measured), ''])
    if absent:
        section.cannot('TINs / rasters', next(iter(absent.values())))
    else:
        section.judge('TINs / rasters', times[ours].least / times[theirs].least, most=1, judged=judged)


def files(subject):
    runner, points = subject.runner, subject.sizes.file_points
    mesh = runner.mesh(f'terrain1-{points}', '--points', points, '--seed', 1)
    runner.progress('reading and writing')
    said = runner.bench('files', mesh, runner.scratch, '--threads', subject.cores, '--repeat', subject.sizes.rounds)
    section = Section('Files', f'{said["faces"]:,} faces, {subject.cores} thread(s), from and to the page cache. '
                      'Memory is the peak beside what was there before, in sizes of the mesh; of reading it holds the '
                      'mesh.')
    section.table = [['', 'MB', 'write, MB/s', 'read, MB/s', 'memory of writing', 'memory of reading']]
    judged = not subject.sizes.scaled
    for name in (n for n, value in said.items() if isinstance(value, dict)):
        costs = said[name]
        section.table.append([name, f'{costs["bytes"] / 1e6:.0f}'] +
                             [f'{costs[way]["bytes_per_second"] / 1e6:.0f}' for way in ('write', 'read')] +
                             [f'{costs[way]["peak_per_mesh"]:.2f}' for way in ('write', 'read')])
        for way in ('write', 'read'):
            rate = costs[way]['bytes_per_second'] / 1e6
            section.judge(f'{way} {name}, MB/s', rate, least=1000 if name == 'ply' else 300, figure=f'{rate:.0f}',
                          judged=judged)
        section.judge(f'{name}, memory', max(costs[way]['peak_per_mesh'] for way in ('write', 'read')), most=1.5,
                      judged=judged)
    a, b = subject.pair(subject.sizes.points)
    whole, kernel = '`subtract a.ply b.ply -o d.ply`', 'overlay within'
    times, absent = subject.take_turns(
        {whole: lambda: runner.terrane('subtract', a, b, '-o', runner.absent('d.ply'))[0],
         kernel: lambda: runner.bench('overlay', a, b, '--threads', subject.cores, '--repeat', 1)['total_seconds']},
        subject.sizes.rounds)
    if absent:
        section.cannot(whole, next(iter(absent.values())))
        return section
    outside = 1 - times[kernel].least / times[whole].least
    section.note(f'{whole}, {subject.sizes.points:,} points each', str(times[whole]))
    section.judge('its share outside the overlay', outside, most=0.5, judged=judged)
    return section
