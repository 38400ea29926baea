# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay: its ratios, its growth, merges of many tiles."""
import os

import plots
from document import Section
from measuring import NotRun, available_bytes, exponent
from subject import ISSUE_POINTS, columns


def overlay(subject):
    runner, points = subject.runner, subject.sizes.points
    a, b = subject.pair(points)
    both = ['--points', points, '--seed']
    utm = ['--x', 500000, '--y', 4500000]
    shuffled = [runner.mesh(f'shuffled{seed}', *both, seed, '--shuffled') for seed in (1, 2)]
    edited = runner.mesh('edited', *both, 1, '--edited')
    far = runner.mesh('far', *both, 1, *utm)
    jittered = runner.mesh('jittered', *both, 1, *utm, '--jitter', 1e-9)
    said = {}

    def ours(name, first, second, threads=1):
        def once():
            said[name] = runner.bench('overlay', first, second, '--threads', threads, '--repeat', 1)
            return said[name]['total_seconds']
        return once

    r, cdt, one, two = 'edge-walk reference (R)', 'CGAL CDT', 'Terrane, 1 thread', 'Terrane, 2 threads'
    special = {'shuffled input': shuffled, 'edited pair': (a, edited), 'identical meshes': (a, a),
               'jitter of 1e-9 at UTM': (far, jittered)}
    contestants = {r: lambda: subject.baselines.edge_walk(columns(a), columns(b)), one: ours(one, a, b)}
    if subject.cores > 1:
        contestants[two] = ours(two, a, b, 2)
    contestants |= {name: ours(name, *meshes) for name, meshes in special.items()}
    contestants[cdt] = lambda: subject.baselines.cgal_cdt(columns(a), columns(b))
    times, absent = subject.take_turns(contestants, subject.sizes.rounds)

    if one in absent:
        raise NotRun(absent[one])
    section = Section('Overlay', f'Two Delaunay TINs of {points:,} random points each, from triangle soup to verified '
                      'indexed mesh, cold: renumbering, adjacency, overlay, heights, rounding and its check. R is the '
                      "reference's preparation and cold overlay; it knows no degenerate case, no holes and no "
                      'verification, and is built with `-march=native`, which ours is not. Files are in canonical '
                      'order, as all of ours; that is found out and saves a sort, which shuffled input pays.')
    faces = said[one]['faces']
    section.table = [['', 'seconds (median)', 'million output faces a second', 'output faces']]
    for name in (r, cdt, one, two, *special):
        if name in times:
            count = said[name]['faces'] if name in said else None
            rate = f'{(count or faces) / times[name].least / 1e6:.1f}' if name not in (r, cdt) else ''
            section.table.append([name, str(times[name]), rate, f'{count:,}' if count else ''])
    judged = points == ISSUE_POINTS and not subject.sizes.scaled
    bars = []

    def ratio(what, above, below, **bound):
        lacking = [absent.get(n, 'it needs two processors') for n in (above, below) if n not in times]
        if lacking:
            section.cannot(what, lacking[0])
            return
        section.judge(what, times[above].least / times[below].least, judged=judged, **bound)
        row = section.rows[-1]
        bars.append((what, f'{row.figure}, asked {row.target}',
                     times[above].least / times[below].least / bound['most'] if 'most' in bound
                     else bound['least'] * times[below].least / times[above].least))

    ratio('Terrane / R', one, r, most=1.3)
    ratio('CGAL CDT / Terrane', cdt, one, least=5.5)
    ratio('one thread / two', one, two, least=1.5)
    ratio('shuffled / ordered', 'shuffled input', one, most=1.3)
    ratio('edited pair / R', 'edited pair', r, most=0.9)
    ratio('identical meshes / R', 'identical meshes', r, most=0.5)
    ratio('jitter of 1e-9 at UTM / R', 'jitter of 1e-9 at UTM', r, most=10)
    if bars:
        plots.shares(os.path.join(subject.folder, 'benchmarks-overlay.svg'),
                     f'Ratios of the overlay beside their bounds, {points:,} points a mesh', bars)
        section.plot = 'benchmarks-overlay.svg'
    return section


def growth(subject):
    section = Section('Growth', 'The overlay alone, one thread, cold; memory is its peak without the inputs.')
    section.table = [['points per mesh', 'output faces', 'seconds (median)', 'µs per face', 'peak MB',
                      'bytes per face', 'R, seconds (median)']]
    ours, reference, memory = [], [], []
    said = None
    for points in subject.sizes.growth:
        needed = 4000 * points
        if available_bytes() < needed:
            section.cannot(f'{points:,} points per mesh', f'it may need {needed / 1e9:.0f} GB of memory')
            continue
        a, b = subject.pair(points)

        def once():
            nonlocal said
            said = subject.runner.bench('overlay', a, b, '--repeat', 1)
            return said['total_seconds']
        names = f'overlay of {points:,} points', f'R of {points:,} points'
        times, absent = subject.take_turns(
            {names[0]: once, names[1]: lambda: subject.baselines.edge_walk(columns(a), columns(b))},
            subject.sizes.rounds)
        if names[0] in absent:
            section.cannot(f'{points:,} points per mesh', absent[names[0]])
            continue
        least, faces, peak = times[names[0]].least, said['faces'], said['peak_bytes']
        ours.append((points, least))
        memory.append((points, peak, peak / faces))
        if names[1] in times:
            reference.append((points, times[names[1]].least))
        section.table.append([f'{points:,}', f'{faces:,}', str(times[names[0]]), f'{least / faces * 1e6:.3f}',
                              f'{peak / 1e6:.0f}', f'{peak / faces:.0f}', str(times.get(names[1], 'not run'))])
    if len(ours) < 2:
        section.cannot('exponents', 'they need two sizes')
        return section
    judged = ours[-1][0] >= 100 * ours[0][0] and not subject.sizes.scaled

    def power(line):
        return exponent(line[0][1], line[-1][1], line[-1][0] / line[0][0])
    section.judge('exponent in time', power(ours), most=1.10, figure=f'{power(ours):.3f}', judged=judged)
    section.judge('exponent in memory', power(memory), most=1.02, figure=f'{power(memory):.3f}', judged=judged)
    section.judge(f'peak bytes per output face at {memory[-1][0]:,}', memory[-1][2], most=120,
                  figure=f'{memory[-1][2]:.0f}', judged=judged)
    series = [('Terrane', power(ours), ours)]
    if len(reference) > 1:
        section.note('exponent in time of the reference', f'{power(reference):.3f}')
        series.append(('R', power(reference), reference))
    else:
        section.cannot('exponent in time of the reference', subject.baselines.missing.get('edge_walk', 'too few runs'))
    plots.growth(os.path.join(subject.folder, 'benchmarks-growth.svg'), 'Growth of the overlay, with exponents',
                 'points per mesh', 'seconds', series)
    section.plot = 'benchmarks-growth.svg'
    return section


def merge(subject):
    points = subject.sizes.tile_points
    section = Section('Merge', f'`terrane merge` of square arrangements of tiles of {points:,} points, neighbours '
                      'overlapping by 5 %; whole processes, from PLY to PLY.')
    section.table = [['tiles', 'seconds (median)', 'ms per tile', 'peak MB']]
    subject.runner.progress('making 64 tiles')
    tiles = {(i, j): subject.runner.mesh(f'tile-{i}-{j}', '--points', points, '--seed', 100 + 8 * j + i,
                                         '--x', 9500 * i, '--y', 9500 * j) for j in range(8) for i in range(8)}
    peak, line = {}, []
    contestants = {}
    for side in (4, 8):
        def once(side=side):
            chosen = [tiles[i, j] for j in range(side) for i in range(side)]
            merged = subject.runner.absent('merged.ply')
            wall, peak[side] = subject.runner.terrane('merge', *chosen, '-o', merged)
            return wall
        contestants[f'merge of {side * side} tiles'] = once
    times, absent = subject.take_turns(contestants, subject.sizes.rounds)
    for side in (4, 8):
        name = f'merge of {side * side} tiles'
        if name in absent:
            section.cannot(name, absent[name])
            continue
        least = times[name].least
        line.append(least)
        section.table.append([str(side * side), str(times[name]), f'{least / side**2 * 1e3:.1f}',
                              f'{peak[side] / 1e6:.0f}'])
    if len(line) == 2:
        section.judge('exponent in the number of tiles, 16 to 64', exponent(*line, 4), most=1.2,
                      judged=not subject.sizes.scaled, limit='with the tiles, not their square: at most 1.2')
    return section
