// What can be undone.

export class History<T> {
  private past: T[] = [];
  private future: T[] = [];

  /** Remembers what was before a change. */
  keep(before: T): void {
    this.past.push(before);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
  }

  /** What was before the last change, which is forgotten. */
  drop(): T | undefined {
    return this.past.pop();
  }

  undo(now: T): T | undefined {
    const before = this.past.pop();
    if (before !== undefined) this.future.push(now);
    return before;
  }

  redo(now: T): T | undefined {
    const after = this.future.pop();
    if (after !== undefined) this.past.push(now);
    return after;
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }
}
