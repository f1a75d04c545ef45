with Interfaces.C;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with System.Storage_Elements; use System.Storage_Elements;
with System; use System;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      --  Reads unmapped memory, in C.
      function C_Length (Text : Address) return Interfaces.C.size_t
        with Import, Convention => C, External_Name => "strlen";
   begin
      Report ("before the crash");
      Report (C_Length (To_Address (1))'Image);
   end Run;

end Plugin;
