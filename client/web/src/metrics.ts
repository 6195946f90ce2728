// The server's metrics: Prometheus' text format, and what the server kept of the last hour.

/** Values by series, which are named as in the text: name{label="value"}. */
export type Samples = Map<string, number>;

export function parseMetrics(text: string): Samples {
  const samples: Samples = new Map();
  for (const line of text.split("\n")) {
    const match = /^([^#\s]\S*) (\S+)$/.exec(line);
    if (match) samples.set(match[1]!, Number(match[2]));
  }
  return samples;
}

/** What GET /metrics/history answers. */
export interface History {
  seconds_ago: number[];
  samples: Record<string, (number | null)[]>;
}

/** The samples of a history, the oldest first, each with its time in seconds of this machine's clock. */
export function* samplesOf(history: History, now: number): Generator<{ time: number; samples: Samples }> {
  const series = Object.entries(history.samples);
  for (const [i, ago] of history.seconds_ago.entries()) {
    const samples: Samples = new Map();
    for (const [name, values] of series) {
      const value = values[i];
      if (typeof value === "number") samples.set(name, value);
    }
    yield { time: now - ago, samples };
  }
}

/** A metric's name without its labels. */
export function familyOf(series: string): string {
  return series.split("{", 1)[0]!;
}

/** The sum over all labels. */
export function sum(samples: Samples, name: string): number {
  let total = 0;
  for (const [key, value] of samples) if (key === name || key.startsWith(`${name}{`)) total += value;
  return total;
}

/** The samples of a metric, by the value of one of its labels. */
export function byLabel(samples: Samples, name: string, label: string): [string, number][] {
  return [...samples].filter(([key]) => key.startsWith(`${name}{`))
    .map(([key, value]) => [new RegExp(`${label}="([^"]*)"`).exec(key)?.[1] ?? "", value]);
}
