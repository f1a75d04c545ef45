function TestCase.run()
  rtf.require_critical(false, "the emergency stop is pressed")
end
