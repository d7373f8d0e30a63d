#!/usr/bin/env python3
"""Draws the figures of the paper from what reproduce_paper.sh measured: plot_paper.py OUT_DIR"""
import json
import os
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt
import numpy as np
import rosbag

YAW = 4
# What the paper prints: 25 % saved at maximum speed, and its table.
PAPER_SAVING = 25.0
PAPER_TABLE = {'FS': 663.0, 'YS': 788.0, 'PS': 764.0}
STYLE = {'font.family': 'serif', 'font.size': 9, 'axes.grid': True, 'grid.alpha': 0.35,
         'axes.spines.top': False, 'axes.spines.right': False}


def load(path):
    with open(path) as stream:
        return json.load(stream)


def save(figure, path):
    figure.savefig(path + '.partial.png', dpi=160)
    os.replace(path + '.partial.png', path)
    plt.close(figure)


def ratio(method, baseline):
    """Median over the rounds of the time as a share of the baseline's in the same round."""
    return float(np.median(np.array(method['rounds_ms']) / np.array(baseline['rounds_ms'])))


def scene_name(scene):
    year = ' 2003' if '2003' in scene['set'] else ''
    return '%s%s (%d×%d×%d)' % (scene['scene'].capitalize(), year, scene['width'], scene['height'],
                                scene['disparity_range'])


def figure4(folder):
    scenes = load(os.path.join(folder, 'speed', 'results.json'))['scenes']
    figure, (times, shares) = plt.subplots(1, 2, figsize=(8.5, 3.8))
    summary = []
    for scene, marker in zip(scenes, 'osD^v<>' * 3):
        methods = {m['method']: m for m in scene['methods']}
        baseline = methods['uniform 16']
        speeds = sorted(float(name.split()[1]) for name in methods if name.startswith('forward'))
        ratios = [ratio(methods['forward %g m/s' % v], baseline) for v in speeds]
        base_ms = float(np.median(baseline['rounds_ms']))
        line, = times.plot(speeds, [r * base_ms for r in ratios], marker=marker, markersize=3.5,
                           linewidth=1, label=scene_name(scene))
        times.axhline(base_ms, color=line.get_color(), linestyle=':', linewidth=1)
        shares.plot(speeds, [100 * (1 - r) for r in ratios], marker=marker, markersize=3.5,
                    linewidth=1, color=line.get_color())
        summary.append({'scene': scene_name(scene), 'set': scene['set'], 'uniform16_ms': base_ms,
                        'speeds': speeds, 'time_ratio': ratios,
                        'saving_percent': 100 * (1 - ratios[-1])})
    times.set_ylim(bottom=0)
    times.set_xlabel('forward speed [m/s]')
    times.set_ylabel('time per image [ms]')
    times.set_title('(a) dotted: SGM with 16 paths everywhere')
    shares.axhline(PAPER_SAVING, color='black', linestyle='--', linewidth=1)
    # Below the line at the right, where no curve runs.
    shares.text(0.98, PAPER_SAVING - 2.0, 'the paper, at maximum speed', fontsize=7, ha='right',
                transform=shares.get_yaxis_transform())
    shares.set_xlabel('forward speed [m/s]')
    shares.set_ylabel('time saved against SGM [%]')
    shares.set_title('(b) time saved')
    shares.set_ylim(bottom=min(0.0, shares.get_ylim()[0]))
    figure.legend(fontsize=7, loc='lower center', ncol=4, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    save(figure, os.path.join(folder, 'fig4.png'))
    return summary


def table1(folder):
    scenes = load(os.path.join(folder, 'states', 'results.json'))['scenes']
    if not scenes:
        return []
    summary = []
    for scene in scenes:
        methods = {m['method']: m for m in scene['methods']}
        base = methods['uniform 16']
        base_ms = float(np.median(base['rounds_ms']))
        row = {'scene': scene_name(scene), 'set': scene['set'], 'SGM': base_ms}
        row['FS'] = base_ms * ratio(methods['forward 10 m/s'], base)
        # Left and right, up and down cost the same work; their mean stands for the state.
        row['YS'] = base_ms * 0.5 * (ratio(methods['yaw left'], base) +
                                     ratio(methods['yaw right'], base))
        row['PS'] = base_ms * 0.5 * (ratio(methods['pitch up'], base) +
                                     ratio(methods['pitch down'], base))
        summary.append(row)
    with open(os.path.join(folder, 'table1.txt'), 'w') as text:
        text.write('%-40s %9s %9s %9s %9s   YS/FS  PS/FS\n' % ('time [ms] at 10 m/s', 'FS', 'YS', 'PS',
                                                               'SGM 16'))
        text.write('%-40s %9.0f %9.0f %9.0f %9s   %5.2f  %5.2f\n' % (
            'the paper, Teddy', PAPER_TABLE['FS'], PAPER_TABLE['YS'], PAPER_TABLE['PS'], '-',
            PAPER_TABLE['YS'] / PAPER_TABLE['FS'], PAPER_TABLE['PS'] / PAPER_TABLE['FS']))
        for row in summary:
            text.write('%-40s %9.2f %9.2f %9.2f %9.2f   %5.2f  %5.2f\n' % (
                row['set'] + ', ' + row['scene'], row['FS'], row['YS'], row['PS'], row['SGM'],
                row['YS'] / row['FS'], row['PS'] / row['FS']))
    return summary


def floats(message):
    return np.frombuffer(message.image.data, np.float32).reshape(message.image.height,
                                                                 message.image.width)


def read(path, topic):
    with rosbag.Bag(path) as bag:
        return {m.header.stamp.to_nsec(): m for _, m, _ in bag.read_messages(topic)}


def focus_of(state):
    """Mask of the cells with the most paths, and its box (x, y, width, height)."""
    mask = np.zeros((state.row_edges[3], state.column_edges[3]), bool)
    paths = list(bytearray(state.paths))
    for cell in range(9):
        if paths[cell] == max(paths):
            row, column = divmod(cell, 3)
            mask[state.row_edges[row]:state.row_edges[row + 1],
                 state.column_edges[column]:state.column_edges[column + 1]] = True
    ys, xs = np.nonzero(mask)
    return mask, (xs.min(), ys.min(), xs.max() - xs.min() + 1, ys.max() - ys.min() + 1)


class Tally:
    """Bad pixels and valid pixels of a region over many frames."""

    def __init__(self):
        self.pixels = self.bad = self.valid = self.bad_valid = 0

    def add(self, disparity, invalid_below, truth, known, region):
        use = known & region
        valid = use & (disparity >= invalid_below)
        wrong = valid & (np.abs(disparity - truth) > 2.0)
        self.pixels += int(use.sum())
        self.valid += int(valid.sum())
        self.bad_valid += int(wrong.sum())
        self.bad += int(use.sum() - valid.sum() + wrong.sum())

    def result(self):
        return {'pixels': self.pixels, 'bad2_percent': 100.0 * self.bad / max(1, self.pixels),
                'bad2_valid_percent': 100.0 * self.bad_valid / max(1, self.valid),
                'density_percent': 100.0 * self.valid / max(1, self.pixels)}


def figure5(folder):
    flight = os.path.join(folder, 'flight.bag')
    left = read(flight, '/stereo/left/image_rect')
    truth = read(flight, '/ground_truth/disparity')
    occlusion = read(flight, '/ground_truth/occlusion')
    results = {name: read(os.path.join(folder, name + '.bag'), '/stereo/disparity')
               for name in ('adaptive', 'uniform')}
    states = read(os.path.join(folder, 'adaptive.bag'), '/stereo/grid_state')
    tallies = {(name, where): Tally() for name in results for where in ('focus', 'outside')}
    yaw_stamps = [stamp for stamp in sorted(states) if states[stamp].state & YAW]
    if not yaw_stamps:
        raise RuntimeError('the flight has no frame in the yaw state')
    for stamp in yaw_stamps:
        expected = floats(truth[stamp])
        known = expected >= 0.5
        if stamp in occlusion:
            hidden = np.frombuffer(occlusion[stamp].data, np.uint8).reshape(expected.shape)
            known = known & (hidden == 0)
        inside, _ = focus_of(states[stamp])
        for name, frames in results.items():
            lowest = frames[stamp].min_disparity
            for where, region in (('focus', inside), ('outside', ~inside)):
                tallies[name, where].add(floats(frames[stamp]), lowest, expected, known, region)
    # The frame in which the focus holds the nearest things, which the paper's red box is about.
    shown = max(yaw_stamps, key=lambda s: np.percentile(floats(truth[s])[focus_of(states[s])[0]], 90))
    draw5(folder, left[shown], floats(truth[shown]), results, states[shown], shown, tallies)
    return {'yaw_frames': len(yaw_stamps),
            'error': {'%s, %s' % key: tally.result() for key, tally in tallies.items()}}


def draw5(folder, left, truth, results, state, stamp, tallies):
    image = np.frombuffer(left.data, np.uint8).reshape(left.height, left.step)[:, :left.width]
    message = results['adaptive'][stamp]
    disparity = np.where(floats(message) >= message.min_disparity, floats(message), np.nan)
    truth = np.where(truth > 0, truth, np.nan)
    error = np.abs(disparity - truth)
    largest = float(np.nanpercentile(truth, 99.5))
    colours = plt.get_cmap('jet').copy()
    colours.set_bad('black')
    _, (x, y, width, height) = focus_of(state)
    figure, axes = plt.subplots(2, 2, figsize=(8, 5.2))
    turn = 'left' if state.yaw_rate > 0 else 'right'
    panels = ((axes[0, 0], image, 'gray', 0, 255, '(a) reference image, turning %s' % turn),
              (axes[0, 1], disparity, colours, 0, largest, '(b) disparity, adaptive grid [px]'),
              (axes[1, 0], truth, colours, 0, largest, '(c) true disparity [px]'),
              (axes[1, 1], error, colours, 0, 4, '(d) error of (b) [px]'))
    for axis, picture, colour_map, low, high, title in panels:
        shown = axis.imshow(picture, cmap=colour_map, vmin=low, vmax=high, interpolation='nearest')
        # The reference image's bar only keeps the panels alike in size.
        bar = figure.colorbar(shown, ax=axis, fraction=0.026, pad=0.02)
        bar.ax.set_visible(colour_map != 'gray')
        axis.add_patch(plt.Rectangle((x - 0.5, y - 0.5), width, height, fill=False, color='red',
                                     linewidth=1.6))
        axis.set_title(title, fontsize=9)
        axis.grid(False)
        axis.set_xticks([])
        axis.set_yticks([])
    numbers = {key: tally.result()['bad2_percent'] for key, tally in tallies.items()}
    figure.text(0.5, 0.015, 'wrong by more than 2 px or missing, all yaw frames: in the focus %.1f %% '
                '(16 paths everywhere: %.1f %%), outside %.1f %% (%.1f %%)' % (
                    numbers['adaptive', 'focus'], numbers['uniform', 'focus'],
                    numbers['adaptive', 'outside'], numbers['uniform', 'outside']),
                ha='center', fontsize=8)
    figure.tight_layout(rect=(0, 0.035, 1, 1))
    save(figure, os.path.join(folder, 'fig5.png'))


def write_tables(folder, summary):
    """The tables of docs/paper.md."""
    lines = ['| image | 16 paths everywhere [ms] | at 20 m/s [ms] | saved |', '|---|---|---|---|']
    for scene in summary['figure4']:
        lines.append('| %s | %.1f | %.1f | %.0f %% |' % (
            scene['scene'], scene['uniform16_ms'], scene['uniform16_ms'] * scene['time_ratio'][-1],
            scene['saving_percent']))
    lines += ['', '| | FS [ms] | YS [ms] | PS [ms] | YS / FS | PS / FS |', '|---|---|---|---|---|---|',
              '| the paper | 663 | 788 | 764 | 1.19 | 1.15 |']
    for row in summary['table1']:
        lines.append('| %s | %.1f | %.1f | %.1f | %.2f | %.2f |' % (
            row['scene'], row['FS'], row['YS'], row['PS'], row['YS'] / row['FS'],
            row['PS'] / row['FS']))
    lines += ['', '| %d yaw frames | wrong by > 2 px or missing | wrong by > 2 px among valid | valid |' %
              summary['figure5']['yaw_frames'], '|---|---|---|---|']
    for name, error in summary['figure5']['error'].items():
        lines.append('| %s | %.2f %% | %.2f %% | %.1f %% |' % (
            name, error['bad2_percent'], error['bad2_valid_percent'], error['density_percent']))
    with open(os.path.join(folder, 'tables.md'), 'w') as stream:
        stream.write('\n'.join(lines) + '\n')


def main():
    if len(sys.argv) != 2:
        print('usage: plot_paper.py OUT_DIR', file=sys.stderr)
        return 2
    folder = sys.argv[1]
    with plt.rc_context(STYLE):
        summary = {'figure4': figure4(folder), 'table1': table1(folder), 'figure5': figure5(folder)}
    with open(os.path.join(folder, 'paper.json'), 'w') as stream:
        json.dump(summary, stream, indent=1)
    write_tables(folder, summary)
    for scene in summary['figure4']:
        print('%-28s uniform 16: %7.2f ms, saved at maximum speed: %4.1f %%' %
              (scene['scene'], scene['uniform16_ms'], scene['saving_percent']))
    with open(os.path.join(folder, 'table1.txt')) as text:
        print(text.read(), end='')
    for name, error in summary['figure5']['error'].items():
        print('yaw frames, %-18s bad-2 %5.2f %% (valid only %5.2f %%), density %5.1f %%' % (
            name, error['bad2_percent'], error['bad2_valid_percent'], error['density_percent']))
    return 0


if __name__ == '__main__':
    sys.exit(main())
