// SPDX-License-Identifier: GPL-3.0-or-later

// Units, ticks and numbers.

/** The unit for lengths up to this one, and its number in a metre.
 * @returns {[string, number]} */
export function lengthUnit(largest_m) {
  return largest_m >= 0.5 ? ["m", 1] : largest_m >= 0.01 ? ["cm", 100] : largest_m >= 2e-4 ? ["mm", 1000] :
      ["\u00b5m", 1e6];
}

/** At most about `max_count` multiples of 1, 2 or 5 times a power of ten from low to high. */
export function ticks(low, high, max_count) {
  const minimum = (high - low) / max_count;
  const power = 10 ** Math.floor(Math.log10(minimum));
  const step = power * ([1, 2, 5].find((digit) => digit * power >= minimum * (1 - 1e-9)) ?? 10);
  const result = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    result.push({value: k * step, text: formatNumber(k * step, step)});
  }
  return result;
}

/** A number with the decimals that a step of this size needs, and a typographic minus sign. */
export function formatNumber(value, step) {
  if (value === null || value === undefined || Number.isNaN(value)) return "\u2013";
  const decimals = step > 0 ? Math.min(10, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))) : 3;
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

/** "1 hole", "2 holes". */
export function counted(count, word) {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

export function metresAs(value_m, unit, factor, digits = 3) {
  return value_m === null ? "\u2013" : `${Number((factor * value_m).toPrecision(digits))} ${unit}`.replaceAll("-", "\u2212");
}
