require "rtf"

class Monitored < RTF::TestCase
  def run
    sample("level", 5, "m")
    monitor("always(level < 2m)", name: "low")
    monitor("always(level > 0m)", severity: "stop")
    monitor("always(level < 2kg)", name: "wrong unit", severity: "error")
    sample("level", 1, "m")
    sample("level", 3, "m")
  end
end
