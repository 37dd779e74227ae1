// A target that is missed, and ways out of it that a test answers with, so that nothing has to be computed for them.

/** A target of one family that is far too stiff for its material. */
export const MISSED = "#/design?task=stress_strain&family=IH29&direction=0&points=0,0;0.05,6;0.1,12&design=IH29&parameters=0.25";

/** The way out of the mock server: the material is 20 times as stiff. */
export const WAY = {
  change: "modulus",
  sentence: "Make it of a material of 520 MPa: 2.1 % instead of 94 % by the model.",
  family: "IH29",
  model: "IH29",
  parameters: [0.25],
  orientation: 0,
  youngs_modulus: 520,
  range: null,
  deviation: 0.021,
};

/** Refuses verifications, which would take long. */
export async function refuseVerifications(page) {
  const refusal = { type: "urn:supple:error:server.overloaded", title: "Overloaded", status: 429, detail: "Not now.", code: "server.overloaded" };
  await page.route("**/v1/designs", (route) =>
    route.request().postDataJSON()?.verify ? route.fulfill({ status: 429, contentType: "application/problem+json", json: refusal }) : route.fallback());
}

/** Answers requests for ways out with these ones, and refuses verifications. */
export async function answerWays(page, ways) {
  await refuseVerifications(page);
  await page.route("**/v1/designs", async (route) => {
    if (route.request().postDataJSON()?.effects?.ways_out !== "on") return route.fallback();
    await route.fulfill({ status: 200, json: { ways_out: ways, cost: { seconds: 1, stages: [], quantities: {} }, effects: [] } });
  });
}
