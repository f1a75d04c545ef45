with Ada.Text_IO;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      for Number in 0 .. 999_999 loop
         Ada.Text_IO.Put_Line ("flood line" & Number'Image);
      end loop;
   end Run;

end Plugin;
