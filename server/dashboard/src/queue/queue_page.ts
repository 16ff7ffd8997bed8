import { h } from "../base/h";
import type { OpenPage } from "../shell/page";

export const openQueuePage: OpenPage = ({ setTitle }) => {
  setTitle("Queue");
  return h("p", null, "Jobs");
};
