/** Tasks of the service, and the names of their rows. */
import { t } from '../i18n';

const TASKS = [
  'pose',
  'position',
  'orientation',
  'xy',
  'xz',
  'yz',
  'xy_phi',
  'xyz_phi',
  'position_direction',
] as const;

/** Options of a select: names of tasks, with their meaning. */
export function taskOptions(): [string, string][] {
  return TASKS.map((one) => [one, `${one} — ${t.tasks[one]}`]);
}

/** A row of a Jacobian as it is written in the field: `wx` is ωx. */
export function rowName(name: string): string {
  return name.replace(/^w/, 'ω');
}
