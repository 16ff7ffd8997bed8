// The files that a job was made from, out of results.tar, of which no more is fetched than they take.
import { filesInTar } from "../base/tar";
import { fetchBytes, urlOf } from "./client";

interface Reproduction {
  readonly inputs: readonly { readonly path: string }[];
}

/** As they came in. Errors: ApiError (404: the job has not succeeded), Error where the archive ends early. */
export async function fetchInputs(id: string, signal?: AbortSignal): Promise<File[]> {
  const response = await fetchBytes(urlOf("/v1/jobs/{id}/results.tar", { path: { id } }), { signal });
  if (!response.body) throw new Error("the archive is empty");
  let wanted: ReadonlySet<string> | null = null;
  const files: File[] = [];
  for await (const { path, bytes } of filesInTar(response.body)) {
    const within = path.split("/").slice(1).join("/"); // the folder is named as the job
    if (within === "reproduce.json")
      wanted = new Set((JSON.parse(new TextDecoder().decode(bytes)) as Reproduction).inputs.map((input) => input.path));
    else if (within.startsWith("input/")) files.push(new File([bytes], within.slice("input/".length)));
    if (wanted !== null && files.length >= wanted.size) return files;
  }
  throw new Error("the archive ended early");
}
