#!/usr/bin/env python3
"""Draws what matcher_benchmark measured: plot_benchmark.py matcher.json matcher.png"""
import json
import os
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt

OURS = {'uniform 16': '#08306b', 'uniform 8': '#2171b5', 'uniform 4': '#6baed6',
        'forward': '#d94801', 'yaw left': '#fd8d3c', 'pitch up': '#fdbe85'}
PEERS = {'StereoBM': '#bdbdbd', 'SGBM 3WAY': '#969696', 'SGBM': '#737373', 'SGBM HH4': '#525252',
         'SGBM HH': '#252525'}


def work(setting):
    """Pixels times disparities, in millions."""
    width, height, disparities = map(int, setting.split('x'))
    return width * height * disparities / 1e6


def draw_bars(axes, table, settings, threads):
    methods = [m for m in list(OURS) + list(PEERS) if (settings[0], m, threads) in table]
    width = 0.85 / len(methods)
    for i, method in enumerate(methods):
        positions = [k + (i - len(methods) / 2 + 0.5) * width for k in range(len(settings))]
        axes.bar(positions, [table[s, method, threads]['median_ms'] for s in settings], width,
                 color={**OURS, **PEERS}[method], label=method)
    axes.set_yscale('log')
    axes.set_xticks(range(len(settings)))
    axes.set_xticklabels([s.replace('x', '×') for s in settings], fontsize=7)
    axes.set_ylabel('time per frame [ms]')
    axes.set_title('%d thread%s' % (threads, 's' if threads > 1 else ''))
    axes.grid(axis='y', which='both', alpha=0.3)


def draw_growth(axes, table, settings, threads):
    for method in ('uniform 16', 'uniform 8', 'uniform 4', 'forward'):
        points = sorted((work(s), table[s, method, t]['median_ms'], t) for s in settings
                        for t in threads if (s, method, t) in table)
        for t in threads:
            axes.plot([p[0] for p in points if p[2] == t], [p[1] for p in points if p[2] == t],
                      marker='o', color=OURS[method], linestyle='-' if t == 1 else '--',
                      label='%s, %d thread%s' % (method, t, 's' if t > 1 else ''))
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_xlabel('pixels × disparities [millions]')
    axes.set_ylabel('time per frame [ms]')
    axes.set_title('growth with the size')
    axes.grid(which='both', alpha=0.3)
    axes.legend(fontsize=7)


def draw_paths(axes, table, settings, threads):
    for k, setting in enumerate(settings):
        points = sorted((table[setting, m, threads]['mean_paths'],
                         table[setting, m, threads]['median_ms']) for m in OURS
                        if (setting, m, threads) in table)
        whole = table[setting, 'uniform 16', threads]['median_ms']
        axes.plot([p[0] for p in points], [p[1] / whole for p in points], 'o', label=setting,
                  color=plt.cm.viridis(k / max(1, len(settings) - 1)))
    axes.plot([0, 16], [0, 1], color='grey', linewidth=1, label='in proportion')
    axes.set_xlim(0, 17)
    axes.set_ylim(0, 1.1)
    axes.set_xlabel('paths per pixel, mean over the plan')
    axes.set_ylabel('time / time of uniform 16')
    axes.set_title('growth with the paths, %d thread%s' % (threads, 's' if threads > 1 else ''))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)


def main():
    if len(sys.argv) != 3:
        print('usage: plot_benchmark.py matcher.json matcher.png', file=sys.stderr)
        return 2
    with open(sys.argv[1]) as stream:
        measured = json.load(stream)
    table = {(s['setting'], s['method'], s['threads']): s for s in measured['series']}
    settings = sorted({key[0] for key in table}, key=work)
    threads = sorted({key[2] for key in table})
    figure, axes = plt.subplots(2, 2, figsize=(13, 9))
    draw_bars(axes[0, 0], table, settings, threads[0])
    draw_bars(axes[0, 1], table, settings, threads[-1])
    axes[0, 1].legend(fontsize=7, ncol=2)
    draw_growth(axes[1, 0], table, settings, threads)
    draw_paths(axes[1, 1], table, settings, threads[0])
    figure.suptitle('%s, %s, OpenCV %s; medians of %d rounds in which all took turns' %
                    (measured['cpu'], measured['simd_target'], measured['opencv'],
                     measured['rounds']))
    figure.tight_layout()
    temporary = sys.argv[2] + '.partial.png'
    figure.savefig(temporary, dpi=110)
    os.replace(temporary, sys.argv[2])
    return 0


if __name__ == '__main__':
    sys.exit(main())
