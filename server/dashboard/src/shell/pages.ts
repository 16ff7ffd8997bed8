// All pages. Each is a script of its own, fetched when it is first opened.
import type { Route } from "./router";

export const pages: readonly Route[] = [
  { pattern: "/", load: async () => (await import("../queue/queue_page")).openQueuePage },
  { pattern: "/new", load: async () => (await import("../new_job/new_job_page")).openNewJobPage },
  { pattern: "/jobs/{id}", load: async () => (await import("../job/job_page")).openJobPage },
  { pattern: "/compare", load: async () => (await import("../job/compare/compare_page")).openComparePage },
  { pattern: "/system", load: async () => (await import("../system/system_page")).openSystemPage },
  { pattern: "/login", load: async () => (await import("./login_page")).openLoginPage },
];
