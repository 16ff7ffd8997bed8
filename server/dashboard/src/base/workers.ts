// Where the workers' scripts are: build.mjs bundles every src/**/NAME_worker.ts by itself and fills this in.
declare const WORKER_URLS: Readonly<Record<string, string>>;

/** The path of the script of src/.../NAME_worker.ts. */
export function workerUrl(name: string): string {
  const url = WORKER_URLS[name];
  if (url === undefined) throw new Error(`there is no worker ${name}`);
  return url;
}
