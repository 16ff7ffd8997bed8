import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openWalk: OpenJobPart = () => h("section", { "aria-label": "Walk" });
