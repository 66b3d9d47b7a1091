/** An HTTP request to the service as data: it is sent, and "Reproduce" writes it as a command. */

/** One request; `Answer` is the type of what the service answers. */
export interface Call<Answer = unknown> {
  readonly method: 'GET' | 'POST';
  /** Below the service's root, without query: `v1/robots/puma560/fk`. */
  readonly path: string;
  readonly query: Readonly<Record<string, string>>;
  /** An object is sent as JSON. */
  readonly body?: unknown;
  /** Content-Type of a body that is a text or a file. */
  readonly type?: string;
  readonly accept?: string;
  /** Carries the type of the answer; never set. */
  readonly answer?: Answer;
}

/** The service's root: the folder of the page, which may be served behind a path prefix. */
export const ROOT = new URL('.', document.baseURI);

export function urlOf(call: Call): string {
  const query = Object.entries(call.query).map(([key, value]) => `${key}=${escaped(value)}`);
  return new URL(call.path, ROOT).href + (query.length ? `?${query.join('&')}` : '');
}

/** Percent-encoding but for commas, colons and slashes, which a query may hold as they are. */
function escaped(text: string): string {
  return encodeURIComponent(text).replaceAll(/%2C|%3A|%2F/gi, decodeURIComponent);
}

/** Path of a stored robot, or of one of its resources: `v1/robots/puma560/fk`. */
export function robotPath(id: string, resource = ''): string {
  return `v1/robots/${encodeURIComponent(id)}${resource && `/${resource}`}`;
}
