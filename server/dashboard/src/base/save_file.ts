// Hands bytes that the page has made to the browser's downloads.
import { h } from "./h";

export function saveFile(bytes: Blob, name: string): void {
  const url = URL.createObjectURL(bytes);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000); // the download has begun by then
}
