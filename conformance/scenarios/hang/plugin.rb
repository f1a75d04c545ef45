require "fiddle"
require "rtf"

class Hang < RTF::TestCase
  # Locked twice, this never comes back, and the interpreter's lock is held: no
  # line of Ruby runs any more in this process.
  def run
    report("going to hang")
    mutex = Fiddle::Pointer.malloc(64, Fiddle::RUBY_FREE)
    mutex[0, 64] = "\0" * 64
    lock = Fiddle::Function.new(Fiddle.dlopen(nil)["pthread_mutex_lock"], [Fiddle::TYPE_VOIDP],
                                Fiddle::TYPE_INT, need_gvl: true)
    2.times { lock.call(mutex) }
  end
end
