// In Node.js 18, the version of Debian 12, the browser's object `crypto` is not global.
import { webcrypto } from "node:crypto";

globalThis.crypto ??= webcrypto as Crypto;
