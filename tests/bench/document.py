# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/benchmarks.md: sections of tables, each figure beside what was asked of it."""
import dataclasses
import os


@dataclasses.dataclass
class Row:
    what: str
    figure: str
    target: str = ''
    share: float | None = None  # of what is allowed: at most 1 is met; None: not judged

    @property
    def verdict(self):
        if not self.target:
            return ''
        return 'not judged' if self.share is None else 'met' if self.share <= 1 else '**not met**'


class Section:
    def __init__(self, title, text):
        self.title, self.text = title, text
        self.rows, self.table, self.plot = [], [], ''

    def note(self, what, figure):
        self.rows.append(Row(what, figure))

    def judge(self, what, value, *, most=None, least=None, figure=None, judged=True, limit=None):
        """A figure and its bound; `judged` is false where the bound is about another size than was measured."""
        share = value / most if most is not None else least / value
        asked = limit or (f'at most {most:g}' if most is not None else f'at least {least:g}')
        self.rows.append(Row(what, figure or f'{value:.2f}', asked, share if judged else None))

    def cannot(self, what, reason):
        self.rows.append(Row(what, f'not run: {reason}'))

    def markdown(self):
        lines = [f'## {self.title}', '', self.text, '']
        if self.table:
            head, *body = self.table
            lines += ['| ' + ' | '.join(head) + ' |', '|' + '---|' * len(head)]
            lines += ['| ' + ' | '.join(cells) + ' |' for cells in body] + ['']
        if self.rows:
            lines += ['| | measured | asked | |', '|---|---|---|---|']
            lines += [f'| {r.what} | {r.figure} | {r.target} | {r.verdict} |' for r in self.rows] + ['']
        if self.plot:
            lines += [f'![{self.title}]({self.plot})', '']
        return lines


def write(folder, conditions, sections, elapsed, scaled):
    """The document itself; plots are beside it."""
    rows = [row for section in sections for row in section.rows]
    verdicts = [row.verdict for row in rows if row.target]
    met, missed = verdicts.count('met'), verdicts.count('**not met**')
    lines = ['# Benchmarks', '',
             'Written by `./dev bench` in one run on one machine. Times are the least of several runs that took turns, '
             'their median beside them.', '']
    lines += [f'- {line}' for line in conditions]
    lines += [f'- {met} of {met + missed} judged figures are as asked. The run took {elapsed / 60:.0f} minutes.']
    if scaled:
        lines += [f'- **{scaled}**']
    lines += ['']
    for section in sections:
        lines += section.markdown()
    lines += ['## What was not run', '']
    absent = [f'- {section.title}, {row.what}: {row.figure.removeprefix("not run: ")}'
              for section in sections for row in section.rows if row.figure.startswith('not run: ')]
    lines += absent or ['Nothing: everything ran.']
    with open(os.path.join(folder, 'benchmarks.md'), 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines).rstrip() + '\n')
