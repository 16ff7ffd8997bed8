import { h } from "../base/h";
import type { OpenPage } from "../shell/page";

export const openNewJobPage: OpenPage = ({ setTitle }) => {
  setTitle("New job");
  return h("p", null, "Drop files here.");
};
