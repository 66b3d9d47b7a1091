/** Numbers as text, and back. */

/** Fixed number of decimals, with a true minus sign; zero to these decimals has no sign. */
export function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/** Significant digits, for quantities of any size; null is infinite. */
export function brief(value: number | null, digits = 4): string {
  if (value === null) return '∞';
  if (value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e6)) {
    return value
      .toExponential(digits - 1)
      .replace('-', '−')
      .replace('e−', 'e-');
  }
  return String(Number(value.toPrecision(digits))).replace('-', '−');
}

/** Text of a number in a field: up to twelve significant digits. */
export function typed(value: number): string {
  return String(Number(value.toPrecision(12)));
}

/** Read a typed number, also with a decimal comma or a true minus; null where it is none. */
export function readNumber(text: string): number | null {
  const plain = text.trim().replace('−', '-').replace(',', '.');
  const value = Number(plain);
  return plain !== '' && Number.isFinite(value) ? value : null;
}
