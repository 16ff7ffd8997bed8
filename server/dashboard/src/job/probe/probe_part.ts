import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openProbe: OpenJobPart = () => h("section", { "aria-label": "Probe" });
