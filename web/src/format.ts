/** Numbers as the page shows them. */

/** With a fixed number of digits; a true minus sign; what is zero to these digits has no sign. */
export function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/** With significant digits, for quantities of any size. */
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

/** For a field that is typed into: all that matters of twelve digits. */
export function typed(value: number): string {
  return String(Number(value.toPrecision(12)));
}

/** What was typed as a number: a decimal comma and a true minus are read, too; null for no number. */
export function readNumber(text: string): number | null {
  const plain = text.trim().replace('−', '-').replace(',', '.');
  const value = Number(plain);
  return plain !== '' && Number.isFinite(value) ? value : null;
}
