import "./shell/theme.css";
import "./shell/shell.css";
import { startShell } from "./shell/shell";

startShell(document.getElementById("app")!);
