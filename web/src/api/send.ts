/** Sends a call, and names the ways in which it can fail. */
import { type Call, urlOf } from './call';
import { anotherKey, key, keyAsked } from './key';
import { pace } from './pace';

/** A request that is refused for a longer time is not sent again by itself, s. */
const MOST_SECONDS = 60;

/** One entry of `errors` in a problem document. */
export interface FieldError {
  /** JSON pointer to the field. */
  readonly pointer: string;
  readonly message: string;
  /** Line of a URDF, from 1. */
  readonly line?: number;
  /** Element of a URDF. */
  readonly xpath?: string;
}

/** The service refused: its problem document (RFC 9457). */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly detail: string,
    readonly errors: readonly FieldError[],
    /** The last part of the problem's type, '' where it is none. */
    readonly kind = '',
    /** How many errors there are besides those that are listed. */
    readonly more = 0,
  ) {
    super(detail);
  }
}

/** No answer arrived. */
export class Unreachable extends Error {}

/** Whether the same request may succeed later: no answer, or a service that is busy or starting. */
export function isTemporary(error: unknown): boolean {
  return (
    error instanceof Unreachable ||
    (error instanceof Refusal && [429, 502, 503, 504].includes(error.status))
  );
}

/**
 * Send a call with the key, if there is one: at the pace of the service, again where it was asked
 * too often, and again with another key where the reader gives one.
 *
 * @throws Refusal for any status but 2xx; Unreachable without an answer; DOMException AbortError.
 */
export async function send(call: Call, signal?: AbortSignal): Promise<Response> {
  const headers: Record<string, string> = {
    Accept: call.accept ?? 'application/json',
    // What the service says stands in the page.
    'Accept-Language': document.documentElement.lang,
  };
  const init: RequestInit = { method: call.method, headers };
  if (signal) init.signal = signal;
  if (call.body !== undefined) {
    headers['Content-Type'] = call.type ?? 'application/json';
    init.body = call.type ? (call.body as string | Blob) : JSON.stringify(call.body);
  }
  for (;;) {
    await keyAsked();
    signal?.throwIfAborted();
    await pace.take(signal);
    const shown = key();
    if (shown) headers['X-API-Key'] = shown;
    else delete headers['X-API-Key'];
    const response = await fetched(urlOf(call), init);
    pace.learn(response.headers);
    if (response.ok) return response;
    if (response.status === 429 && pace.refused(response.headers) <= MOST_SECONDS) continue;
    if (response.status === 401 && (await anotherKey(shown))) continue;
    throw await refusal(response);
  }
}

/**
 * Whether the service accepts a key.
 *
 * @throws Refusal, Unreachable as `send`.
 */
export async function isAccepted(given: string): Promise<boolean> {
  const headers = { Accept: 'application/json', 'X-API-Key': given };
  for (;;) {
    await pace.take();
    const url = urlOf({ method: 'GET', path: 'v1/robots', query: { page_size: '1' } });
    const response = await fetched(url, { headers });
    pace.learn(response.headers);
    if (response.ok || response.status === 401) return response.ok;
    if (response.status !== 429 || pace.refused(response.headers) > MOST_SECONDS) {
      throw await refusal(response);
    }
  }
}

async function fetched(url: string, init: RequestInit): Promise<Response> {
  try {
    return await fetch(url, init);
  } catch (error) {
    if (error instanceof DOMException) throw error;
    throw new Unreachable(String(error));
  } finally {
    pace.ended();
  }
}

async function refusal(response: Response): Promise<Refusal> {
  try {
    const problem = (await response.json()) as {
      type?: string;
      detail?: string;
      errors?: FieldError[];
      more_errors?: number;
    };
    return new Refusal(
      response.status,
      problem.detail ?? response.statusText,
      problem.errors ?? [],
      problem.type?.split('/').pop(),
      problem.more_errors,
    );
  } catch {
    return new Refusal(response.status, response.statusText, []);
  }
}

/** Send a call and read its answer as JSON. */
export async function json<Answer>(call: Call<Answer>, signal?: AbortSignal): Promise<Answer> {
  return (await (await send(call, signal)).json()) as Answer;
}

/** Send a call and read its answer as text. */
export async function text(call: Call<string>, signal?: AbortSignal): Promise<string> {
  return (await send(call, signal)).text();
}
