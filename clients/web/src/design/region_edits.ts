// Changes of the regions of the product, and of the one that is selected.
import { MAX_REGION_NAME_LENGTH, MAX_REGIONS, regionsOf, withRegions } from "./region_list";
import type { DesignSession } from "./session";
import type { Region } from "./state";

export class RegionEdits {
  constructor(private readonly session: DesignSession) {}

  /** All regions, in the order of their tabs. */
  get all(): readonly Region[] {
    return regionsOf(this.session.state.get());
  }

  /** Selects another region and shows its stored results. If there are none, a search starts. */
  select(at: number): void {
    const { session } = this;
    session.finish();
    const { all } = this;
    if (at === session.state.get().regionAt || at < 0 || at >= all.length) return;
    session.leaveRegion();
    session.edited.amend({ ...session.state.get(), ...withRegions(all, at) });
    this.enter();
  }

  /** Adds a region, a copy of the selected one. */
  add(): void {
    const { session } = this;
    session.finish();
    const { all } = this;
    if (all.length >= MAX_REGIONS) return;
    session.leaveRegion();
    session.results.copyRegion();
    const { regionAt } = session.state.get();
    session.edited.change(withRegions([...all, { ...all[regionAt], region: "" }], all.length));
    session.push();
    this.enter();
  }

  /** Makes the product one of regions with these names: those that have a name already stay, and the others are copies of the selected one. */
  make(names: readonly string[]): void {
    const { session } = this;
    session.finish();
    const { all } = this;
    const { regionAt } = session.state.get();
    const sources = names.slice(0, MAX_REGIONS).map((name) => {
      const known = all.findIndex(({ region }) => region.toLowerCase() === name.toLowerCase());
      return { name: name.slice(0, MAX_REGION_NAME_LENGTH), from: known >= 0 ? known : regionAt };
    });
    if (sources.length === 0) return;
    session.leaveRegion();
    session.results.copyRegions(sources.map(({ from }) => from));
    session.edited.change(withRegions(sources.map(({ name, from }) => ({ ...all[from], region: name })), 0));
    session.push();
    this.enter();
  }

  remove(at: number): void {
    const { session } = this;
    session.finish();
    const { all } = this;
    if (all.length === 1) return;
    session.leaveRegion();
    session.results.dropRegion(at);
    const { regionAt } = session.state.get();
    session.edited.change(withRegions(all.filter((_, k) => k !== at), at < regionAt ? regionAt - 1 : regionAt));
    session.push();
    this.enter();
  }

  rename(name: string): void {
    this.session.rename({ region: name.trim().slice(0, MAX_REGION_NAME_LENGTH) });
  }

  /** Searches for the designs of all regions in one request. */
  searchAll(): void {
    this.session.finish();
    this.session.search.searchRegions();
  }

  private enter(): void {
    const { results, search } = this.session;
    results.showCached();
    if (!results.isCurrent || results.shown.get()?.provisional) search.refresh("search");
  }
}
