function TestCase.run()
  -- Until then, the child looks like its shell.
  local is_renamed = 'until [ "$(cat /proc/$!/comm)" = sleep ]; do sleep 0.01; done'
  os.execute("setsid bash -c 'exec -a rtf-left-behind sleep 1000' & " .. is_renamed)
  rtf.report("child started")
end
