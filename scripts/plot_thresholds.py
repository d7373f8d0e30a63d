#!/usr/bin/env python3
"""Draws what tune_thresholds found: plot_thresholds.py DATA.json PICTURE.png (called by the tool)."""
import json
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

BANDS = (('LOCKED', 1, '#7f7f7f'), ('FORWARD', 2, '#2ca02c'), ('YAW', 4, '#1f77b4'),
         ('PITCH', 8, '#d62728'))


def series(data, name):
    return np.array([np.nan if value is None else value for value in data[name]], dtype=float)


def draw_rate(axis, time, rate, threshold, hysteresis, label, color):
    axis.plot(time, rate, color=color, linewidth=0.7)
    for sign in (-1, 1):
        axis.axhline(sign * threshold, color='black', linewidth=0.8)
        axis.axhline(sign * threshold * hysteresis, color='black', linewidth=0.8, linestyle=':')
    limit = max(1.6 * threshold, np.nanpercentile(np.abs(rate), 99.7))
    axis.set_ylim(-limit, limit)
    axis.set_ylabel(label)
    axis.grid(alpha=0.3)


def draw_flight(axes, data):
    time, suggested = series(data, 'time'), data['suggested']
    axes[0].plot(time, series(data, 'speed'), color='#2ca02c', linewidth=0.9)
    axes[0].axhline(suggested['lock_speed'], color='black', linewidth=0.8, linestyle=':',
                    label='lock_speed')
    axes[0].axhline(suggested['max_speed'], color='black', linewidth=0.8, label='max_speed')
    axes[0].set_ylabel('forward speed [m/s]')
    axes[0].legend(loc='lower right', fontsize=8)
    axes[0].grid(alpha=0.3)
    draw_rate(axes[1], time, series(data, 'yaw'), suggested['yaw'], suggested['hysteresis'],
              'yaw rate [rad/s]\n(left positive)', '#1f77b4')
    draw_rate(axes[2], time, series(data, 'pitch'), suggested['pitch'], suggested['hysteresis'],
              'pitch rate [rad/s]\n(up positive)', '#d62728')
    state = np.array(data['state'], dtype=int)
    for row, (_, bit, color) in enumerate(BANDS):
        axes[3].fill_between(time, row, row + 0.85, where=(state & bit) != 0, color=color,
                             step='post', linewidth=0)
    axes[3].set_yticks([row + 0.4 for row in range(len(BANDS))])
    axes[3].set_yticklabels([name for name, _, _ in BANDS])
    axes[3].set_ylim(0, len(BANDS))
    axes[3].set_xlabel('time [s]')
    for axis in axes:
        axis.set_xlim(time[0], time[-1])


def draw_distribution(axis, data):
    moving = series(data, 'speed') > data['suggested']['lock_speed']
    for name, color in (('yaw', '#1f77b4'), ('pitch', '#d62728')):
        rate = np.sort(np.abs(series(data, name)[moving]))
        rate = rate[np.isfinite(rate)]
        axis.plot(rate, 100 * (1 - np.arange(rate.size) / max(1, rate.size)), color=color,
                  label='|%s rate|' % name)
        axis.axvline(data['suggested'][name], color=color, linestyle='--', linewidth=0.9,
                     label='threshold of ' + name.upper())
    axis.set_xlabel('rate [rad/s]')
    axis.set_ylabel('flight above it [%]')
    axis.set_ylim(0, 100)
    axis.set_xlim(left=0)
    axis.legend(fontsize=8)
    axis.grid(alpha=0.3)


def draw_grid(axis, data, name, title, form, factor=1.0):
    sigmas = sorted({row['sigma1'] for row in data['grid']})
    table = np.zeros((len(sigmas), len(sigmas)))
    for row in data['grid']:
        table[sigmas.index(row['sigma2']), sigmas.index(row['sigma1'])] = factor * row[name]
    image = axis.imshow(table, origin='lower', cmap='viridis', aspect='auto')
    middle = 0.5 * (table.min() + table.max())
    for (y, x), value in np.ndenumerate(table):
        axis.text(x, y, form % value, ha='center', va='center', fontsize=7,
                  color='white' if value < middle else 'black')
    labels = ['%.1f' % sigma for sigma in sigmas]
    axis.set_xticks(range(len(sigmas)))
    axis.set_xticklabels(labels)
    axis.set_yticks(range(len(sigmas)))
    axis.set_yticklabels(labels)
    axis.set_xlabel('sigma1')
    axis.set_ylabel('sigma2')
    axis.set_title(title, fontsize=10)
    return image


def main():
    if len(sys.argv) != 3:
        sys.exit('usage: plot_thresholds.py DATA.json PICTURE.png')
    with open(sys.argv[1]) as file:
        data = json.load(file)
    figure = plt.figure(figsize=(15, 11))
    grid = figure.add_gridspec(5, 3, height_ratios=(1, 1, 1, 0.8, 1.9), hspace=0.5, wspace=0.25)
    flight = [figure.add_subplot(grid[row, :]) for row in range(4)]
    draw_flight(flight, data)
    for axis in flight[:3]:
        axis.tick_params(labelbottom=False)
    draw_distribution(figure.add_subplot(grid[4, 0]), data)
    draw_grid(figure.add_subplot(grid[4, 1]), data, 'changes', 'state changes a minute', '%.0f')
    draw_grid(figure.add_subplot(grid[4, 2]), data, 'cost', 'cost [% of 16 paths everywhere]',
              '%.0f', 100.0)
    figure.suptitle(data['title'] + '  (lines: suggested thresholds, dotted: left below)',
                    y=0.92, fontsize=11)
    figure.savefig(sys.argv[2], dpi=90, bbox_inches='tight', format='png')


if __name__ == '__main__':
    main()
