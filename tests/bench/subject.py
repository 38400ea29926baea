# SPDX-License-Identifier: GPL-3.0-or-later
"""What every section needs: sizes, meshes, and runs that take turns."""
import dataclasses
import os

from measuring import NotRun, Times, seconds

ISSUE_POINTS = 250_000  # the size the bounds on ratios are about


@dataclasses.dataclass
class Sizes:
    points: int = ISSUE_POINTS
    growth: tuple = (25_000, 250_000, 2_500_000)
    tile_points: int = 10_000
    dem: int = 4097
    raster: int = 4097
    file_points: int = 2_250_000
    rounds: int = 5
    scaled: str = ''  # why bounds are not judged, empty where they are


@dataclasses.dataclass
class Subject:
    """What a section needs: the runner, the baselines, the sizes, where plots go."""
    runner: object
    baselines: object
    sizes: Sizes
    folder: str

    @property
    def cores(self):
        return len(os.sched_getaffinity(0))

    def pair(self, points):
        return [self.runner.mesh(f'terrain{seed}-{points}', '--points', points, '--seed', seed, '--columns')
                for seed in (1, 2)]

    def take_turns(self, contestants, rounds):
        """Runs each in turn, `rounds` times; times by name, and by name why one could not run."""
        times, absent = {name: Times() for name in contestants}, {}
        for turn in range(rounds):
            for name, contestant in contestants.items():
                if name in absent:
                    continue
                try:
                    times[name].add(contestant())
                    self.runner.progress(f'{name}, run {turn + 1} of {rounds}: {seconds(times[name].seconds[-1])} s')
                except NotRun as reason:
                    absent[name] = str(reason)
                    self.runner.progress(f'{name}: not run: {reason}')
        return {name: t for name, t in times.items() if name not in absent}, absent


def columns(path):
    return path.removesuffix('.ply') + '.bin'
