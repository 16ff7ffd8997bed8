// Images and video: the rendered frames in step with the timeline, other views, and everything there is to download.
import { h } from "../../base/h";
import type { OpenJobPart } from "../job_part";
import { downloads } from "./downloads";
import { framePlayer } from "./frame_player";
import { videoPlayer } from "./video_player";
import { views } from "./views";
import "./images.css";

export const openImages: OpenJobPart = (context) =>
  h("section", { class: "images", "aria-label": "Images and video" },
    framePlayer(context), videoPlayer(context), views(context), downloads(context));
