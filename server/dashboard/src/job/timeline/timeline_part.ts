import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openTimeline: OpenJobPart = () => h("section", { "aria-label": "Timeline" });
