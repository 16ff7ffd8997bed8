import { h } from "../../base/h";
import type { OpenPage } from "../../shell/page";

export const openComparePage: OpenPage = ({ setTitle }) => {
  setTitle("Compare");
  return h("p", null, "Choose two jobs.");
};
