import "./shell/theme.css";
import { startShell } from "./shell/shell";

startShell(document.getElementById("app")!);
