// Axes of charts: ranges, ticks and their labels, linear and logarithmic.

import {numberText, superscript} from './dom.js';

// Numbers between these sizes are written without a power of ten.
const smallest_plain = 1e-3;
const largest_plain = 1e6;
// Decades that are written out: 0.01 .. 1000.
const lowest_plain_decade = -2;
const highest_plain_decade = 3;

function orderOf(value) {
  return Math.floor(Math.log10(value) + 1e-9);
}

/// The least and the largest of values that an axis can show; null where there is none.
export function extent(values, log) {
  let low = Infinity,
    high = -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value) || (log && value <= 0)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : null;
}

/// The range of an axis that shows values from low to high: whole decades, or a margin at both ends.
export function axisRange(values, log, margin) {
  const found = extent(values, log);
  if (log) {
    const low = found ? Math.floor(Math.log10(found[0]) + 1e-9) : 0;
    const high = found ? Math.ceil(Math.log10(found[1]) - 1e-9) : 1;
    return low === high ? [10 ** (low - 1), 10 ** (high + 1)] : [10 ** low, 10 ** high];
  }
  const [low, high] = found ?? [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low <= 1e-10 * size || size === 0) {
    const around = size > 0 ? 0.1 * size : 1;
    return [low - around, high + around];
  }
  return [low - margin * (high - low), high + margin * (high - low)];
}

// The least of 1, 2, 5 times a power of ten from 0.65 `wanted` on.
function roundStep(wanted) {
  const decade = 10 ** orderOf(wanted);
  return [1, 2, 5, 10].map((step) => step * decade).find((step) => step >= 0.65 * wanted);
}

// Very large and very small numbers of an axis share one power of ten. `whole`: between whole numbers there is nothing,
// so that no tick is there either, unless the axis has been zoomed into until it shows no whole number.
function linearTicks([low, high], most, whole) {
  const usual = roundStep((high - low) / most);
  const step = whole && high - low >= 1 ? Math.max(1, usual) : usual;
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const exponent = largest >= smallest_plain && largest < largest_plain ? 0 : orderOf(largest);
  const decimals = Math.min(20, Math.max(0, exponent - orderOf(step)));
  const unit = exponent === 0 ? '' : `·10${superscript(exponent)}`;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    const text = ((k * step) / 10 ** exponent).toFixed(decimals).replace('-', '−');
    ticks.push({at: k * step, label: k === 0 ? '0' : text + unit});
  }
  return ticks;
}

// Labels of an axis that has the decades first to last: all of them powers, or none.
function decadeLabels(first, last) {
  const plain = first >= lowest_plain_decade && last <= highest_plain_decade;
  return (decade) => (plain ? (10 ** decade).toFixed(Math.max(0, -decade)) : `10${superscript(decade)}`);
}

// Decades, with 2 and 5 where there is room; within less than a decade the ticks of a linear axis.
function logTicks([low, high], most) {
  const first = Math.ceil(Math.log10(low) - 1e-9),
    last = Math.floor(Math.log10(high) + 1e-9);
  if (last - first < 1) {
    const inner = logSteps(low, high, [1, 2, 5]);
    return inner.length > 2 ? inner : linearTicks([low, high], most, false);
  }
  if (3 * (last - first) <= most + 1) return logSteps(low, high, [1, 2, 5]);
  const step = Math.max(1, Math.ceil((last - first) / most));
  const label = decadeLabels(first, last);
  const ticks = [];
  for (let decade = first; decade <= last; decade += step) ticks.push({at: 10 ** decade, label: label(decade)});
  return ticks;
}

function logSteps(low, high, multiples) {
  const label = decadeLabels(orderOf(low), orderOf(high));
  const ticks = [];
  for (let decade = orderOf(low); decade <= orderOf(high); ++decade) {
    for (const multiple of multiples) {
      const at = multiple * 10 ** decade;
      if (at < low * (1 - 1e-9) || at > high * (1 + 1e-9)) continue;
      ticks.push({at, label: multiple === 1 ? label(decade) : numberText(at, 2)});
    }
  }
  return ticks;
}

/// Ticks of an axis, at most about `most`; `whole`: its values are whole numbers, and so are ticks of a linear axis.
export function axisTicks(range, log, most, whole) {
  return log ? logTicks(range, most) : linearTicks(range, most, whole);
}

/// Places of the thin lines between decades; none where there are too many decades.
export function minorPlaces([low, high]) {
  if (Math.log10(high / low) > 6) return [];
  return logSteps(low, high, [2, 3, 4, 5, 6, 7, 8, 9]).map((tick) => tick.at);
}

/// "angle (deg)" -> its name and unit.
export function labelParts(label) {
  const found = /^(.*?)\s*\(([^()]*)\)\s*$/.exec(label);
  return found ? {name: found[1], unit: found[2]} : {name: label, unit: ''};
}
