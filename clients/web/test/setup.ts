// Node.js 18, which Debian 12 has, keeps the browser's cryptography in a module.
import { webcrypto } from "node:crypto";

globalThis.crypto ??= webcrypto as Crypto;
