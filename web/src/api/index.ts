/**
 * Client of the public REST API, one function an endpoint.
 *
 * There is no kinematics in the page: every number on it comes from here. A function makes a `Call`,
 * a description of the HTTP request, which `send`, `json` or `text` sends. The functions in `./motion`
 * and `./files` are imported from there: they are not loaded with the first screen.
 */
export * from './call';
export * from './computations';
export * from './key';
export * from './pace';
export * from './robots';
export * from './send';
export * from './tables';
export * from './types';
