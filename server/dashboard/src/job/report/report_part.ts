import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openReport: OpenJobPart = () => h("section", { "aria-label": "Report" });
