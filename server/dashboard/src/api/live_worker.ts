// The shared worker: one event stream for all tabs of this browser. Browsers open six connections to a service at
// most, and the service has places for a few dozen listeners.
import { Follower, type LiveMessage } from "./follower";

// The types of workers and of pages exclude each other in one project; this is all we need of them.
interface SharedWorkerScope {
  onconnect: ((event: MessageEvent) => void) | null;
}

const kPortsMax = 64;
const ports: MessagePort[] = [];
let follower: Follower | null = null;

function tell(message: LiveMessage): void {
  for (const port of ports) port.postMessage(message);
}

(self as unknown as SharedWorkerScope).onconnect = (event) => {
  const port = event.ports[0]!;
  ports.push(port);
  // Tabs that were closed do not say so.
  if (ports.length > kPortsMax) ports.shift();
  port.onmessage = ({ data }) => {
    if (data === "retry") follower?.retry();
    if (data === "bye") ports.splice(ports.indexOf(port) >>> 0, 1);
  };
  if (!follower) {
    follower = new Follower(tell);
    void follower.run();
  }
  port.postMessage({ kind: "connection", state: follower.connection } satisfies LiveMessage);
};
