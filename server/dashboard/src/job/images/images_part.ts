import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";

export const openImages: OpenJobPart = () => h("section", { "aria-label": "Images" });
