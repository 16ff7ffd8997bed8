import { h } from "../base/h";
import type { OpenPage } from "../shell/page";

export const openSystemPage: OpenPage = ({ setTitle }) => {
  setTitle("System");
  return h("p", null, "System");
};
