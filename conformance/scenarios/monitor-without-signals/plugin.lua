function TestCase.run()
  rtf.monitor("always(level < 2m)")
end
