/// <reference types="vite/client" />
declare module "*.obj?url" {
  const url: string;
  export default url;
}
