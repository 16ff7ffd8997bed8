import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openRelight: OpenJobPart = () => h("section", { "aria-label": "Relight" });
