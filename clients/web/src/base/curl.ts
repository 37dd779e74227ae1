/** A request as a curl command. */
export function curlText(origin: string, path: string, request: unknown): string {
  return `curl -sS ${origin}${path} \\\n  -H 'Content-Type: application/json' \\\n  -d '${JSON.stringify(request).replace(/'/g, "'\\''")}'\n`;
}
