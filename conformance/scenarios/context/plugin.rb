require "rtf"

class Context < RTF::TestCase
  def run
    report("#{name} #{param} #{environment} #{repetition}")
  end
end
