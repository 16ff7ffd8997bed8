// Writes generated/openapi.d.ts, the types of requests and answers, from api/openapi.yaml.
import { mkdirSync, writeFileSync } from "node:fs";
import openapiTS, { astToString } from "openapi-typescript";

const document = new URL("../../api/openapi.yaml", import.meta.url);
const folder = new URL("generated/", import.meta.url);
mkdirSync(folder, { recursive: true });
writeFileSync(new URL("openapi.d.ts", folder), astToString(await openapiTS(document)));
