function TestCase.run()
  rtf.sample("level", 5, "m")
  rtf.monitor("always(level < 2m)", "low")
  rtf.monitor("always(level > 0m)", nil, "stop")
  rtf.monitor("always(level < 2kg)", "wrong unit", "error")
  rtf.sample("level", 1, "m")
  rtf.sample("level", 3, "m")
end
