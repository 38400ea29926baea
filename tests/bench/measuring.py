# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmark knows of the machine, and how it runs and times programs."""
import datetime
import json
import math
import os
import platform
import shlex
import statistics
import subprocess
import sys
import tempfile
import time


class NotRun(Exception):
    """A measurement that cannot be made here; its text says why."""


class Times:
    """Seconds of several runs of one thing."""

    def __init__(self):
        self.seconds = []

    def add(self, seconds):
        self.seconds.append(seconds)

    @property
    def least(self):
        return min(self.seconds)

    def __str__(self):
        return f'{seconds(self.least)} s (median {seconds(statistics.median(self.seconds))})'


def seconds(value):
    return f'{value:.3f}' if value < 10 else f'{value:.1f}'


def exponent(small, large, growth):
    """e where large = small * growth^e."""
    return math.log(large / small) / math.log(growth)


class Runner:
    """Runs programs in a folder of its own, one at a time, and says on stderr what it does."""

    def __init__(self, build, scratch):
        self.build, self.scratch = os.path.abspath(build), scratch
        self.start = time.monotonic()

    def elapsed(self):
        return time.monotonic() - self.start

    def progress(self, text):
        print(f'[{self.elapsed():6.0f} s] {text}', file=sys.stderr, flush=True)

    def file(self, name):
        return os.path.join(self.scratch, name)

    def absent(self, name):
        """The path of a file that is not there: to replace one takes time of its own."""
        path = self.file(name)
        if os.path.exists(path):
            os.remove(path)
        return path

    def run(self, *words):
        """Standard output, wall seconds and peak bytes of a whole process."""
        words = [str(word) for word in words]
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            begin = time.monotonic()
            try:
                process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.scratch)
            except OSError as reason:
                raise NotRun(f'`{os.path.basename(words[0])}`: {reason.strerror}') from reason
            _, status, usage = os.wait4(process.pid, 0)
            wall = time.monotonic() - begin
            process.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            err.seek(0)
            if process.returncode != 0:
                complaint = err.read().decode(errors='replace').strip().splitlines()
                command = shlex.join(map(os.path.basename, words[:3]))
                last = complaint[-1] if complaint else 'no word'
                raise NotRun(f'`{command} …` ended with {process.returncode}: {last}')
            return out.read().decode(), wall, usage.ru_maxrss * 1024

    def bench(self, *words):
        """What a subcommand of terrane-bench says."""
        return json.loads(self.run(os.path.join(self.build, 'terrane-bench'), *words)[0])

    def terrane(self, *words):
        """Wall seconds and peak bytes of the command line."""
        return self.run(os.path.join(self.build, 'terrane'), *words)[1:]

    def mesh(self, name, *options):
        path = self.file(name + '.ply')
        if not os.path.exists(path):
            self.bench('mesh', path, *options)
        return path


def _field(path, key, otherwise='unknown'):
    try:
        with open(path, encoding='utf-8') as lines:
            for line in lines:
                if line.startswith(key):
                    return line[len(key):].strip(' \t:="\n')
    except OSError:
        pass
    return otherwise


def available_bytes():
    return int(_field('/proc/meminfo', 'MemAvailable', '0 kB').split()[0]) * 1024


def _others_running():
    """How many threads of others run just now, and how many of these gave way (nice > 0)."""
    running = polite = 0
    for name in os.listdir('/proc'):
        if not name.isdigit() or int(name) == os.getpid():
            continue
        try:
            with open(f'/proc/{name}/stat', encoding='utf-8', errors='replace') as stat:
                fields = stat.read().rpartition(')')[2].split()
        except OSError:
            continue
        if fields[0] == 'R':
            running += 1
            polite += int(fields[16]) > 0
    return running, polite


def _said(*words, cwd=None):
    try:
        return subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ''


def conditions(root):
    """Sentences on where and when this was measured; taken before the first measurement."""
    load = os.getloadavg()[0]
    memory = int(_field('/proc/meminfo', 'MemTotal', '0 kB').split()[0]) / 2**20
    compiler = _said('c++', '--version').partition('\n')[0] or 'unknown compiler'
    commit = _said('git', 'describe', '--always', '--dirty', cwd=root) or 'unknown'
    lines = [
        f'{_field("/proc/cpuinfo", "model name")}, {os.cpu_count()} processors, {memory:.0f} GiB, '
        f'{_field("/etc/os-release", "PRETTY_NAME")}, Linux {platform.release()}.',
        f'{compiler}; commit {commit}.',
        f'{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d %H:%M} UTC; load average at the start {load:.2f}, '
        f'own niceness {os.nice(0)}.']
    if load > 1:
        running, polite = _others_running()
        lines.append(f'The machine was or had just been busy; at that moment {running} other processes were running, '
                     f'{polite} of them at lower priority (`nice`). Runs of one comparison took turns, and ratios are '
                     f'of minima.')
    return lines
