// The scene of an upload before it is lit, as the service reads it.
import { ApiError, errorOf } from "../api/api_error";

/** Errors: ApiError. */
export async function previewOf(form: FormData, signal: AbortSignal): Promise<ArrayBuffer> {
  let response: Response;
  try {
    response = await fetch("/v1/preview", { method: "POST", body: form, credentials: "same-origin", signal });
  } catch (error) {
    if (signal.aborted) throw error;
    throw new ApiError(0, "The service does not answer. Is it running?");
  }
  if (!response.ok) throw await errorOf(response);
  return response.arrayBuffer();
}
