# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots as small SVG files, readable on light and dark pages."""
import math
from xml.sax.saxutils import escape

STYLE = ('<style>text{font:13px sans-serif;fill:#333}.grid{stroke:#ccc}.axis{stroke:#666;stroke-width:1.5}'
         '.a{fill:#2a78d6}.b{fill:#d9622b}polyline.a{stroke:#2a78d6}polyline.b{stroke:#d9622b}'
         'polyline{fill:none!important;stroke-width:2.5}'
         '@media(prefers-color-scheme:dark){text{fill:#ddd}.grid{stroke:#444}.axis{stroke:#aaa}}</style>')


def _text(x, y, words, anchor='start'):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'


def _save(path, width, height, title, body):
    with open(path, 'w', encoding='utf-8') as file:
        size = f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
        head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img"><title>{escape(title)}</title>{STYLE}'
        file.write('\n'.join([head, *body, '</svg>\n']))


def _power(value):
    for size, unit in ((1e9, 'G'), (1e6, 'M'), (1e3, 'k')):
        if value >= size:
            return f'{value / size:g} {unit}'
    return f'{value:g}'


def growth(path, title, across, up, series):
    """Log-log lines; series: (name, exponent or None, [(x, y), …]), two at most."""
    width, height, left, right, top, bottom = 720, 380, 70, 190, 40, 50
    points = [p for _, _, line in series for p in line]
    span = [(math.floor(math.log10(min(p[k] for p in points))), math.ceil(math.log10(max(p[k] for p in points))))
            for k in (0, 1)]
    span = [(low, high if high > low else low + 1) for low, high in span]

    def place(x, y):
        across_share = (math.log10(x) - span[0][0]) / (span[0][1] - span[0][0])
        up_share = (math.log10(y) - span[1][0]) / (span[1][1] - span[1][0])
        return left + across_share * (width - left - right), height - bottom - up_share * (height - top - bottom)

    body = [_text(left, 20, f'{title}; {up}')]
    for decade in range(span[0][0], span[0][1] + 1):
        x, y = place(10.0**decade, 10.0**span[1][0])
        body += [f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{y:.1f}"/>',
                 _text(x, y + 18, _power(10.0**decade), 'middle')]
    for decade in range(span[1][0], span[1][1] + 1):
        x, y = place(10.0**span[0][0], 10.0**decade)
        body += [f'<line class="grid" x1="{x:.1f}" x2="{width - right}" y1="{y:.1f}" y2="{y:.1f}"/>',
                 _text(x - 8, y + 4, _power(10.0**decade), 'end')]
    body.append(_text((left + width - right) / 2, height - 10, across, 'middle'))
    taken = -math.inf
    for (name, power, line), colour in sorted(zip(series, 'ab'), key=lambda s: -s[0][2][-1][1]):
        placed = [place(x, y) for x, y in line]
        body.append(f'<polyline class="{colour}" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in placed)}"/>')
        body += [f'<circle class="{colour}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>' for x, y in placed]
        taken = max(placed[-1][1] + 4, taken + 18)
        body += [f'<rect class="{colour}" x="{width - right + 12}" y="{taken - 10:.1f}" width="10" height="10"/>',
                 _text(width - right + 28, taken, name if power is None else f'{name}: {power:.2f}')]
    _save(path, width, height, title, body)


def shares(path, title, bars):
    """What was measured as a share of what is allowed; bars: (name, figure and bound, share)."""
    left, right, step, top = 270, 190, 26, 62
    width, height = 760, top + step * len(bars) + 16
    most = max([1.5] + [min(share, 3) for _, _, share in bars])

    def place(share):
        return left + min(share, most) / most * (width - left - right)

    body = [_text(10, 22, title), _text(place(1), top - 10, 'allowed', 'middle')]
    for row, (name, figure, share) in enumerate(bars):
        y = top + step * row
        body += [_text(left - 8, y + 14, name, 'end'),
                 f'<rect class="{"a" if share <= 1 else "b"}" x="{left}" y="{y + 2}" '
                 f'width="{place(share) - left:.1f}" height="{step - 8}" rx="2"/>',
                 _text(width - right + 10, y + 14, figure)]
    body.append(f'<line class="axis" x1="{place(1):.1f}" x2="{place(1):.1f}" y1="{top - 6}" y2="{height - 12}"/>')
    _save(path, width, height, title, body)
