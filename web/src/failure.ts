/** What a request that failed says to the reader. */
import { Refusal, Unreachable } from './api';
import { t } from './i18n';

/** The words of a refusal or of a missing answer; any other error is thrown on. */
export function reasonOf(error: unknown): string {
  if (error instanceof Refusal) {
    if (error.status === 401) return t.keyNeeded;
    return error.kind === 'forbidden' ? t.keyOnlyReads : error.detail;
  }
  if (error instanceof Unreachable) return t.unreachable;
  throw error;
}

/** The same, with what the service says of each field. */
export function reasonsOf(error: unknown, separator: string): string {
  const isOfKey = error instanceof Refusal && [401, 403].includes(error.status);
  const fields = error instanceof Refusal && !isOfKey ? error.errors.map((one) => one.message) : [];
  return fields.join(separator) || reasonOf(error);
}
